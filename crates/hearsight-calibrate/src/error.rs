//! Why nothing could be calibrated, and what is missing.

use thiserror::Error;

/// A calibration that is refused. Each says what was brought and what is needed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CalibrateError {
    /// A description of a board that no board fits.
    #[error("{name} is {value}; {rule}")]
    Board {
        /// What is wrong with it.
        name: &'static str,
        /// What was given.
        value: String,
        /// What is allowed, in words.
        rule: &'static str,
    },
    /// A picture of another size than the first.
    #[error(
        "a picture has {found_width} x {found_height} pixels, the first {width} x {height}; take all with one camera at one \
         resolution"
    )]
    Size {
        /// Pixels a row of the first.
        width: usize,
        /// Rows of the first.
        height: usize,
        /// Pixels a row of the other.
        found_width: usize,
        /// Rows of the other.
        found_height: usize,
    },
    /// No picture shows the board.
    #[error(
        "the board is seen in none of {pictures} pictures; check the numbers of its squares and its dictionary, and that it \
         is sharp, evenly lit and fills a quarter of the picture or more"
    )]
    NeverSeen {
        /// Pictures looked at.
        pictures: usize,
    },
    /// Too few pictures show the board.
    #[error(
        "the board is seen in {seen} of {pictures} pictures, at least {needed} are needed; take more, turned about by 20 to \
         45 degrees each, near all corners of the picture"
    )]
    TooFewViews {
        /// Pictures with the board.
        seen: usize,
        /// Pictures looked at.
        pictures: usize,
        /// Pictures with the board that are needed.
        needed: usize,
    },
    /// The pictures are so much alike that many lenses explain them.
    #[error(
        "the pictures of the board do not tell the focal length: it is turned alike in all of them; take some that are \
         tilted by 20 to 45 degrees to all sides"
    )]
    NotTilted,
    /// Nobody was seen.
    #[error(
        "nobody who may speak is seen; let one person walk about before the camera, face towards it, and talk for a minute \
         or more"
    )]
    SpeakerNeverSeen,
    /// Nothing was heard.
    #[error(
        "no sound is louder than the noise while somebody is seen; check the levels and that the recordings overlap"
    )]
    SpeakerNeverHeard,
    /// Too little to tell anything: frames count around which somebody is seen for as long as the clock may be off.
    #[error(
        "somebody is seen throughout, whatever the clock, in {frames} frames of sound, at least {needed} are needed; record \
         one or two minutes of someone who talks and walks about in view, or search less with --offset"
    )]
    TooLittleSpeech {
        /// Frames with somebody seen.
        frames: usize,
        /// Frames needed.
        needed: usize,
    },
    /// What is heard does not come from where anybody is seen.
    #[error(
        "only {share:.0} % of the sound fits a face anywhere within {offset_s} s and {turn_deg} degrees; check the order of \
         the channels, and that the person who talks is the one who is seen"
    )]
    DoesNotFit {
        /// Share of the frames that fit, percent.
        share: f64,
        /// Largest clock offset tried, seconds.
        offset_s: f64,
        /// Largest turn tried, degrees.
        turn_deg: f64,
    },
    /// The best answer lies outside of what was to be searched, so that it is none.
    #[error(
        "the best fit is a clock {offset_s:.2} +- {offset_deviation_s:.2} s off and a turn of {turn:.0} +- {turn_deviation:.0} \
         degrees, which reaches beyond the {most_s} s and {most_deg} degrees that are searched; faces and sound hardly \
         tell: record longer, nearer, with one person who talks and walks to and fro, or declare clock and direction better"
    )]
    Outside {
        /// Clock offset found, seconds.
        offset_s: f64,
        /// Its standard deviation.
        offset_deviation_s: f64,
        /// Turn found, degrees.
        turn: f64,
        /// Its standard deviation.
        turn_deviation: f64,
        /// Largest clock offset searched, seconds.
        most_s: f64,
        /// Largest turn searched, degrees.
        most_deg: f64,
    },
    /// Two answers far apart fit nearly as well.
    #[error(
        "a clock {offset_s:.2} s off with a turn of {turn:.0} degrees and one {other_offset_s:.2} s off with a turn of \
         {other_turn:.0} degrees fit about equally well; who walks one way only looks the same late as turned: record \
         longer, nearer, with one person who talks and walks to and fro, or search less with --offset and --turn"
    )]
    Ambiguous {
        /// Clock offset that fits best, seconds.
        offset_s: f64,
        /// Its turn, degrees.
        turn: f64,
        /// The other clock offset, seconds.
        other_offset_s: f64,
        /// Its turn, degrees.
        other_turn: f64,
    },
    /// Numbers that no equation can be solved for.
    #[error("the equations have no solution: {0}")]
    Singular(&'static str),
}
