//! `scenes.jsonl`: what `hearsight track` found, a scene a line.
//!
//! In pictures only tracks that are seen count, as in `.mot.txt`: scorers count what can be seen. In the world all do.

use super::truth::{few_enough, lines, schema_fits, stream_of};
use super::{FormatInfo, ReadError, Source, is_time};
use crate::measure::Place;
use crate::recording::{Names, Observation, Recording, Scope, Stream, TurnMaker};
use crate::sequence::Sighting;
use hearsight_core::record::{SCENE_SCHEMA_VERSION, Scene, TrackPhase, TrackRecord};

pub(super) const FORMAT: FormatInfo = FormatInfo {
    name: "scenes",
    meaning: "scenes.jsonl of `hearsight track`; tracks in pictures and in the world, who speaks.",
    recognize: |_, line| line.starts_with('{') && line.contains("\"tracks\""),
    read,
};

fn read(source: &Source<'_>) -> Result<Recording, ReadError> {
    let mut names = Names::default();
    let mut recording = Recording {
        streams: vec![Stream::new(Scope::World, true)],
        ..Recording::default()
    };
    let mut turns = TurnMaker::default();
    let mut has_sound = false;
    let mut latest_s = f64::NEG_INFINITY;
    for found in lines::<Scene>(source) {
        let (line, scene) = found?;
        schema_fits(source, line, &scene.schema, SCENE_SCHEMA_VERSION)?;
        let time_s = scene.time_s;
        if !(is_time(time_s) && time_s > latest_s) {
            let cure = "times must ascend and be within 1e9 s; leave out the line";
            return Err(ReadError::invalid(
                source.path,
                line,
                "time_s",
                &time_s.to_string(),
                cure,
            ));
        }
        latest_s = time_s;
        few_enough(source, line, "tracks", scene.tracks.len())?;
        recording.streams[0].begin(scene.tick, Some(time_s));
        turns.instant(time_s);
        has_sound |= scene.speaker.is_some() || scene.nobody_probability.is_some();
        let mut met: Vec<u64> = Vec::with_capacity(scene.tracks.len());
        // Cameras without a new frame show the one before again: it was taken already.
        let newest: Vec<Option<u64>> = recording.streams.iter().map(Stream::newest).collect();
        for track in &scene.tracks {
            if met.contains(&track.id) {
                let cure = "it is there twice in the scene; leave out one of the two";
                return Err(ReadError::invalid(
                    source.path,
                    line,
                    "id",
                    &track.id.to_string(),
                    cure,
                ));
            }
            met.push(track.id);
            let who = names.index(track.id, || track.id.to_string());
            if let Some(place) = track.position_m.map(Place::World) {
                add(
                    &mut recording.streams[0],
                    track,
                    who,
                    place,
                    &mut recording.set_aside,
                );
            }
            for view in track.views.iter().filter(|_| track.phase == TrackPhase::Visible) {
                let index = stream_of(source, line, &mut recording.streams, &view.camera)?;
                let stream = &mut recording.streams[index];
                match newest.get(index).copied().flatten() {
                    Some(newest) if newest >= view.frame => continue,
                    _ if stream.newest() == Some(view.frame) => {}
                    _ => stream.begin(view.frame, Some(time_s)),
                }
                add(
                    stream,
                    track,
                    who,
                    Place::Box(view.head),
                    &mut recording.set_aside,
                );
            }
        }
        if let Some(speaker) = scene.speaker {
            turns.speaks(names.index(speaker, || speaker.to_string()));
        }
    }
    let (turns, span_s) = turns.finish();
    recording.turns = has_sound.then_some(turns);
    recording.span_s = span_s;
    recording.speakers.clone_from(&names.names);
    recording.names = names.names;
    Ok(recording)
}

fn add(stream: &mut Stream, track: &TrackRecord, who: u32, place: Place, set_aside: &mut u64) {
    let twice = stream
        .newest_observations()
        .iter()
        .any(|other| other.seen.who == who);
    if !place.is_finite() || twice {
        *set_aside += 1;
        return;
    }
    // What is no probability is not known, as in the other formats.
    let probability = |value: Option<f64>| value.filter(|value| (0.0..=1.0).contains(value));
    stream.push(Observation::new(Sighting {
        who,
        place,
        speaking: track.speaking_probability.map(|_| track.speaking),
        speaking_probability: probability(track.speaking_probability),
        existence: probability(Some(track.existence)),
    }));
}
