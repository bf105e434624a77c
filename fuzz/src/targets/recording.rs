//! What the judge reads: truth and tracks of every format, known by their first line.

use super::{Target, Verdict, texts};
use hearsight_eval::metrics::FAMILIES;
use hearsight_eval::read::{FORMATS, parse};
use hearsight_eval::{Case, Options, Recording, Report, Side, pair};
use std::path::Path;

const SEEDS: &[&str] = &[
    include_str!("../../seeds/recording/truth.jsonl"),
    include_str!("../../seeds/recording/scenes.jsonl"),
    include_str!("../../seeds/recording/gt.txt"),
    include_str!("../../seeds/recording/test.txt"),
    include_str!("../../seeds/recording/speech.rttm"),
    include_str!("../../seeds/recording/frames.csv"),
    include_str!("../../seeds/recording/tracks.csv"),
    // What went wrong once.
    include_str!("../../seeds/went-wrong/recording/no-probability"),
    include_str!("../../seeds/went-wrong/recording/time-of-1e308"),
    include_str!("../../seeds/went-wrong/recording/turn-of-ages"),
];

pub(super) const TARGET: Target = Target {
    name: "recording",
    meaning: "Truth or tracks; who was read has a name and a place, and can be judged by values within their ranges.",
    text: true,
    words: &[
        "\"tracks\":[]",
        "\"people\":[]",
        "\"views\":[]",
        "\"id\":1",
        "\"camera\":\"b\"",
        "\"frame\":1",
        "\"time_s\":0.1",
        "\"speaker\":2",
        "\"present\":false",
        "\"occluded\"",
        "null",
        "true",
        "SPEAKER a 1 0 1 <NA> <NA> anna",
        "SPKR-INFO",
        "LEXEME",
        ";;",
        "person",
        "p3_u,p3_v",
        "t_sec",
        "frame",
        "nan",
        "inf",
        ",",
        ",,",
        "\r\n",
        "\n",
    ],
    longest: 8 << 10,
    seeds: || texts(SEEDS),
    open: || {
        let known: Vec<Recording> = SEEDS
            .iter()
            .filter_map(|text| read(text.as_bytes()).ok())
            .collect();
        Box::new(move |bytes| match read(bytes) {
            Ok(recording) => usable(&recording)
                .and_then(|()| judged(&recording, &recording))
                .and_then(|by_itself| {
                    let mut pairs = 0;
                    for other in &known {
                        pairs += judged(&recording, other)? + judged(other, &recording)?;
                    }
                    let (people, streams) = (recording.names.len(), recording.streams.len());
                    Ok(format!(
                        "{} people in {}, {by_itself} and {pairs} cases",
                        people.min(5),
                        streams.min(5)
                    ))
                })
                .map_or_else(Verdict::Broken, Verdict::Read),
            Err(message) => Verdict::Refused(message),
        })
    },
};

/// Every format reads or refuses the bytes, on either side.
fn read(bytes: &[u8]) -> Result<Recording, String> {
    let path = Path::new("a");
    for format in FORMATS {
        // Whether it is read is no matter, for most are of another format.
        let _ = parse(path, bytes, Side::Tracks, Some(format));
    }
    parse(path, bytes, Side::Truth, None).map_err(|error| error.to_string())
}

fn usable(recording: &Recording) -> Result<(), String> {
    for stream in &recording.streams {
        for frame in stream.frames() {
            for (place, observation) in frame.observations.iter().enumerate() {
                let who = observation.seen.who;
                if who as usize >= recording.names.len() {
                    return Err(format!("person {who} of {} names", recording.names.len()));
                }
                if !observation.seen.place.is_finite() {
                    return Err(format!("{:?} is not finite", observation.seen));
                }
                if frame.observations[..place]
                    .iter()
                    .any(|other| other.seen.who == who)
                {
                    return Err(format!("person {who} is twice in frame {}", frame.number));
                }
            }
        }
    }
    for turn in recording.turns.iter().flatten() {
        if turn.speaker as usize >= recording.speakers.len() || !turn.start_s.is_finite() {
            return Err(format!("{turn:?} of {} speakers", recording.speakers.len()));
        }
    }
    Ok(())
}

/// How many cases came of both sides; what is wrong with a value otherwise. Sides without anything in common give none.
fn judged(truth: &Recording, tracks: &Recording) -> Result<usize, String> {
    let options = Options {
        azimuth_from_m: Some([0.0, 0.4]),
        ..Options::default()
    };
    let Ok(paired) = pair("", truth, tracks, &options) else {
        return Ok(0);
    };
    within_ranges(&paired.cases)?;
    let count = paired.cases.len();
    let names = ["truth".to_owned(), "tracks".to_owned()];
    if let Ok(report) = Report::new(names, paired.cases, paired.notes, options) {
        let page = report.html();
        if page.contains("NaN") || page.contains("inf\"") || !page.ends_with("</html>\n") {
            return Err("the page is not whole".to_owned());
        }
        if report.table().is_empty() || !report.json().is_object() {
            return Err("there is no table or no object".to_owned());
        }
    }
    Ok(count)
}

fn within_ranges(cases: &[Case]) -> Result<(), String> {
    for family in FAMILIES {
        let Ok(Some(judged)) = family.judge(cases) else {
            continue;
        };
        for (info, value) in family.metrics().iter().zip(&judged.overall) {
            let Some(value) = value else { continue };
            let [least, most] = info.range;
            if !(least - 1e-9..=most + 1e-9).contains(value) {
                return Err(format!("{} is {value}, not within {least} to {most}", info.name));
            }
        }
    }
    Ok(())
}
