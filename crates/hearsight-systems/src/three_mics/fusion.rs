//! Sounds and faces put together: which face a sound suits, who speaks, and where they are.

use super::parameters::Parameters;
use super::sensors::{Listened, View};
use hearsight_core::Span;
use hearsight_tracking::sight_and_sound::{
    Activity, Heard, Place, SightLine, Verdict, associate, log_likelihood_at,
};
use hearsight_tracking::sound::PointEstimate;

/// A face as the fusion sees it.
#[derive(Clone, Copy)]
struct Sight {
    identity: u64,
    line: SightLine,
}

/// What is believed of all faces together, and what the newest frame of sound says of them.
pub(super) struct Fusion {
    floor_m: f64,
    pub(super) activity: Activity,
    pub(super) places: Vec<Place>,
    sights: Vec<Sight>,
    /// The faces that survive with the followed sound, and the strain of each.
    matches: Vec<(u64, f64)>,
    /// By how much each face explains the newest frame worse than the best place of the room.
    fits: Vec<(u64, f64)>,
    /// Where the sound of the newest frame and each face that survives with it meet.
    pub(super) meetings: Vec<(u64, PointEstimate)>,
}

impl Fusion {
    /// Nobody yet; `floor_m` is the height of the floor.
    pub(super) fn new(floor_m: f64) -> Self {
        Self {
            floor_m,
            activity: Activity::default(),
            places: Vec::new(),
            sights: Vec::new(),
            matches: Vec::new(),
            fits: Vec::new(),
            meetings: Vec::new(),
        }
    }

    /// Gathers the published faces of all cameras and follows their places.
    pub(super) fn gather(&mut self, views: &[View], parameters: &Parameters) {
        self.sights.clear();
        let (sights, places) = (&mut self.sights, &mut self.places);
        for view in views {
            for face in view.faces.published() {
                let Some(identity) = face.identity else { continue };
                let Some(line) = view.sight(face, parameters) else {
                    continue;
                };
                sights.push(Sight { identity, line });
                match places.iter_mut().find(|place| place.identity == identity) {
                    Some(place) if view.elapsed > Span::ZERO => {
                        place.see(&line, view.elapsed, &parameters.place);
                    }
                    Some(_) => {}
                    None => places.extend(Place::new(identity, &line, parameters.association.face_width())),
                }
            }
        }
        self.places
            .retain(|place| self.sights.iter().any(|sight| sight.identity == place.identity));
        self.activity
            .follow(self.sights.iter().map(|sight| sight.identity));
    }

    /// Takes in a frame of one of `arrays` arrays, each of which tells its share of who speaks.
    pub(super) fn hear(&mut self, mut heard: Listened<'_>, arrays: i64, parameters: &Parameters) {
        let elapsed = heard.elapsed / arrays;
        let estimate = heard.sound.estimate().filter(|_| heard.followed);
        self.match_faces(estimate, parameters);
        let heard_now = if parameters.beyond.at_faces {
            self.fit_faces(&mut heard, parameters);
            Heard::Frame(heard.frame.voice.into(), &self.fits)
        } else if estimate.is_some() {
            Heard::Sound(&self.matches)
        } else {
            Heard::Silence
        };
        self.activity.hear(heard_now, elapsed, &parameters.activity);
        self.place_speakers(&mut heard, elapsed, parameters);
    }

    /// Which faces survive with the followed sound, and where both meet (section 4 of the paper).
    fn match_faces(&mut self, estimate: Option<PointEstimate>, parameters: &Parameters) {
        self.matches.clear();
        self.meetings.clear();
        let Some(estimate) = estimate else { return };
        for sight in &self.sights {
            let found = associate(&sight.line, &estimate, self.floor_m, &parameters.association);
            let Some(found) = found.filter(|found| found.verdict == Verdict::Survives) else {
                continue;
            };
            self.matches.push((sight.identity, found.strain));
            let covariance = found.meeting.covariance.unwrap_or(estimate.covariance);
            let mean = found.meeting.point;
            self.meetings
                .push((sight.identity, PointEstimate { mean, covariance }));
        }
    }

    /// How well the frame itself fits where the faces are, beside the best place of the room.
    fn fit_faces(&mut self, heard: &mut Listened<'_>, parameters: &Parameters) {
        self.fits.clear();
        let best = heard.sound.best(heard.response);
        let Some(best) = best else { return };
        let [low_m, high_m] = parameters.association.height_m;
        for Sight { identity, line } in &self.sights {
            let place = self.places.iter().find(|place| place.identity == *identity);
            // What looks like a face below the floor or above heads says nothing.
            let height_m = place.map(|place| place.estimate().mean.0.z - self.floor_m);
            if height_m.is_some_and(|height_m| !(low_m..=high_m).contains(&height_m)) {
                continue;
            }
            let below = log_likelihood_at(line, place, heard.response) - best;
            self.fits.push((*identity, f64::from(below.min(0.0))));
        }
    }

    /// Lets the sound tell how far those are who may be speaking.
    fn place_speakers(&mut self, heard: &mut Listened<'_>, elapsed: Span, parameters: &Parameters) {
        if !heard.followed {
            return;
        }
        for place in &mut self.places {
            let probability = self.activity.probability_of(place.identity);
            let mut sights = self.sights.iter();
            let sight = sights.find(|sight| sight.identity == place.identity);
            if let Some(sight) = sight.filter(|_| probability >= parameters.place.sure) {
                place.hear(
                    &sight.line,
                    heard.response,
                    probability,
                    elapsed,
                    &parameters.place,
                );
            }
        }
    }

    /// The face that speaks, if any does.
    pub(super) fn speaker(&self, parameters: &Parameters) -> Option<u64> {
        self.activity.speaking(&parameters.activity)
    }

    /// Whether the followed sound of the newest frame survives with a face.
    pub(super) fn suits(&self, identity: u64) -> bool {
        self.matches.iter().any(|(met, _)| *met == identity)
    }

    /// Where a person is: in the weighted form what is believed of the place, in the plain one where the lines meet.
    pub(super) fn position(
        &self,
        identity: u64,
        speaks: bool,
        parameters: &Parameters,
    ) -> Option<PointEstimate> {
        if parameters.association.weighted && parameters.beyond.face_range {
            let place = self.places.iter().find(|place| place.identity == identity)?;
            return Some(place.estimate());
        }
        let meeting = self.meetings.iter().find(|(met, _)| *met == identity && speaks);
        meeting.map(|(_, estimate)| *estimate)
    }
}
