//! The list of all pieces of work.

mod faces;
mod pictures;
mod rendering;
mod rooms;
mod sounds;
mod states;

use crate::{Failure, Inputs};

/// Work that is ready: each call does it once, on the next picture where it works on pictures, and gives a number that
/// depends on the result. After as many calls as there are pictures it has done the same again.
pub type Work = Box<dyn FnMut() -> f64>;

/// What work is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Pixels.
    Pictures,
    /// Cascades.
    Faces,
    /// Samples.
    Sounds,
    /// Simulated rooms.
    Rooms,
    /// Particles.
    States,
}

/// A piece of work, by name.
#[derive(Clone, Copy)]
pub struct Kernel {
    /// Its name.
    pub name: &'static str,
    /// One sentence: what is done, and what the number means that it gives.
    pub meaning: &'static str,
    /// What it is about.
    pub topic: Topic,
    prepare: fn(&Inputs) -> Result<Work, Failure>,
}

impl Kernel {
    /// The work of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        KERNELS.iter().find(|kernel| kernel.name == name)
    }

    /// The names of all work of a topic.
    pub fn names(topic: Topic) -> impl Iterator<Item = &'static str> {
        KERNELS
            .iter()
            .filter(move |kernel| kernel.topic == topic)
            .map(|kernel| kernel.name)
    }

    /// Makes it ready.
    ///
    /// # Errors
    /// Where something that it needs is missing on this machine.
    pub fn prepare(&self, inputs: &Inputs) -> Result<Work, Failure> {
        (self.prepare)(inputs)
    }
}

macro_rules! kernels {
    ($($topic:ident $name:literal = $prepare:expr, $meaning:literal;)*) => {
        /// Every piece of work there is.
        pub const KERNELS: &[Kernel] = &[
            $(Kernel { name: $name, meaning: $meaning, topic: Topic::$topic, prepare: $prepare },)*
        ];
    };
}

kernels! {
    Pictures "integral_320x240" = |i| pictures::sums(i, 320, 240), "Sums of a grey picture; the sum of all.";
    Pictures "integral_360x288" = |i| pictures::sums(i, 360, 288), "Sums of a grey picture; the sum of all.";
    Pictures "squares_320x240" = |i| pictures::squares(i, 320, 240), "Sums and sums of squares; the latter of all.";
    Pictures "squares_360x288" = |i| pictures::squares(i, 360, 288), "Sums and sums of squares; the latter of all.";
    Pictures "tilted_360x288" = pictures::tilted, "Sums, squares and tilted sums; the sum of all.";
    Pictures "bins" = pictures::bins, "The histogram bin of every pixel; that of the last.";
    Pictures "histograms" = pictures::histograms, "200 ellipses each scored for two people; the mean likeness.";
    Pictures "change" = pictures::change, "Colour change between two pictures, cleaned; pixels changed.";
    Pictures "background" = pictures::background, "What differs from the learnt background; pixels that do.";
    Pictures "heads" = pictures::heads, "Heads on the outline of a mask with two people; their number.";
    Faces "faces_alt2" = |i| faces::search(i, "alt2"), "All faces of a picture of 20 pixels or more; their number.";
    Faces "faces_default" = |i| faces::search(i, "default"), "All faces of 24 pixels or more; their number.";
    Faces "windows_alt2" = faces::windows, "200 single windows of 20 to 80 pixels; stages passed in all.";
    Rooms "render" = |i| rendering::render(i, false), "A picture of 640 x 480 with three people; how much of them is seen.";
    Rooms "render_turning" = |i| rendering::render(i, true), "The same by a camera that turns.";
    Sounds "phat_8192" = sounds::phase_transform, "GCC-PHAT of a pair, 4096 samples padded to 8192; the delay.";
    Sounds "bands" = sounds::bands, "A frame of a pair at 12 kHz in three bands that must agree; the delay.";
    Rooms "room_response" = |_| rooms::response(), "An impulse response of order 66 from nothing; its energy.";
    Rooms "room_response_again" = |_| rooms::another(), "The same where the images are listed; its energy.";
    Rooms "meeting_16k" = |_| rooms::meeting(16_000), "A second of three walkers at eight microphones; its energy.";
    Rooms "meeting_44k" = |_| rooms::meeting(44_100), "The same at 44.1 kHz; its energy.";
    States "particle_step" = states::step, "1000 particles, six dimensions: predict, weigh, resample; the mean.";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_work_can_be_done_and_repeats_itself() {
        let inputs = Inputs::synthetic();
        for kernel in KERNELS {
            assert!(kernel.meaning.ends_with('.'), "{}", kernel.name);
            let mut work = match kernel.prepare(&inputs) {
                Ok(work) => work,
                Err(failure) => {
                    eprintln!("{}: {failure}", kernel.name);
                    continue;
                }
            };
            let round = |work: &mut Work| (0..inputs.pictures.len()).map(|_| work()).collect::<Vec<f64>>();
            let (first, second) = (round(&mut work), round(&mut work));
            assert!(
                first.iter().all(|number| number.is_finite()),
                "{}: {first:?}",
                kernel.name
            );
            // These remember what they did before.
            let remembering = [
                "particle_step",
                "background",
                "meeting_16k",
                "meeting_44k",
                "render",
                "render_turning",
            ];
            if !remembering.contains(&kernel.name) {
                assert_eq!(first, second, "{}", kernel.name);
            }
        }
    }

    #[test]
    fn names_are_unique() {
        for (place, kernel) in KERNELS.iter().enumerate() {
            assert!(
                KERNELS[..place].iter().all(|other| other.name != kernel.name),
                "{}",
                kernel.name
            );
        }
    }
}
