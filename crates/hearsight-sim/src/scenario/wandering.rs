//! People who walk about by themselves.

use super::actions::USUAL_SPEED_M_S;
use super::people::Draft;
use super::raw::RawAction;
use super::resolve::Resolver;
use super::surroundings::Surroundings;
use crate::acoustics::random::{between, generator};
use crate::world::{Figure, LARGEST_SPEED_M_S, Pace};
use hearsight_core::configuration::{ConfigurationError, Field};
use nalgebra::Point2;

/// Rests of those who walk about, seconds: from and to.
const WANDER_REST_S: [f64; 2] = [0.5, 4.0];

impl Resolver {
    /// Walks between drawn places with rests until a time.
    pub(super) fn wander(
        &self,
        field: &Field,
        raw: &RawAction,
        time: f64,
        surroundings: &Surroundings,
        draft: &mut Draft,
    ) -> Result<(), ConfigurationError> {
        let area = raw.wander.unwrap_or_default();
        let at = field.key("wander");
        for (number, [x, y]) in area.iter().enumerate() {
            self.inside(&at.index(number), [*x, *y, 0.0])?;
        }
        let Some(until) = raw.until.filter(|until| until.is_finite() && *until > time) else {
            return Err(self.missing(field, "until", "say when they stop walking about, in seconds"));
        };
        let speed = match self.pace(
            field,
            &RawAction {
                until: None,
                ..raw.clone()
            },
            time,
        )? {
            Pace::Speed(speed) => speed,
            Pace::Arrive(_) => USUAL_SPEED_M_S,
        };
        let radius = Figure::of(&draft.looks).radius_m + 0.1;
        let mut random = generator(draft.seed, "wander", (time * 1000.0) as u64);
        let mut now = time.max(draft.motion.end_s());
        while now < until {
            let here = draft.motion.end().place;
            let found = (0..100).find_map(|_| {
                let x = between(
                    &mut random,
                    area[0][0].min(area[1][0]),
                    area[0][0].max(area[1][0]) + 1e-9,
                );
                let y = between(
                    &mut random,
                    area[0][1].min(area[1][1]),
                    area[0][1].max(area[1][1]) + 1e-9,
                );
                let there = Point2::new(x, y);
                ((there - here).norm() > 0.4 && self.is_free(here, there, radius, surroundings))
                    .then_some(there)
            });
            let Some(there) = found else {
                let what = format!("finds no way from ({:.2}, {:.2})", here.x, here.y);
                return Err(self.wrong(&at, what, "make the area larger, or move furniture out of it"));
            };
            let before = draft.motion.clone();
            let walked = draft.motion.walk(now, &[there], Pace::Speed(speed));
            walked.map_err(|refusal| self.refused(field, time, LARGEST_SPEED_M_S, refusal))?;
            if draft.motion.end_s() > until {
                draft.motion = before;
                break;
            }
            now = draft.motion.end_s() + between(&mut random, WANDER_REST_S[0], WANDER_REST_S[1]);
        }
        Ok(())
    }

    /// Whether a straight way is free of walls and furniture.
    fn is_free(&self, from: Point2<f64>, to: Point2<f64>, radius: f64, surroundings: &Surroundings) -> bool {
        let way = to - from;
        let steps = (way.norm() / 0.1).ceil().max(1.0) as usize;
        // Whoever gets up from a seat is in it at first.
        let low = surroundings
            .footprints
            .iter()
            .filter(|piece| piece.heights_m[0] < 1.9);
        let obstacles: Vec<_> = low.filter(|piece| !piece.touches(from, radius)).collect();
        (1..=steps).all(|step| {
            let place = from + way * (step as f64 / steps as f64);
            let inside = place.x >= radius
                && place.y >= radius
                && place.x <= self.size_m[0] - radius
                && place.y <= self.size_m[1] - radius;
            inside && !obstacles.iter().any(|piece| piece.touches(place, radius))
        })
    }
}
