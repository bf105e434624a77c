//! Takes pictures.

use super::band::{Band, Scene};
use super::bins::{BAND_ROWS, Bins};
use super::develop::{Developer, Development};
use super::figure::Figure;
use super::hash::mix;
use super::lamps::Lamps;
use super::sight::{Identity, Outline};
use super::stage::Stage;
use super::view::{SAMPLES, View};
use super::{Picture, Shot};
use crate::world::Setting;
use hearsight_core::CameraModel;
use rayon::prelude::*;

/// Cameras whose room is kept; beyond them it is drawn anew when they take turns.
const MOST_VIEWS: usize = 64;
/// People whose textures are kept.
const MOST_FIGURES: usize = 256;
/// People in a picture; more are not drawn.
const MOST_PEOPLE: usize = 4096;
/// People are drawn more often while the shutter is open where something of them moves farther than this, pixels.
const FAST_PX: f32 = 6.0;

/// Takes pictures of one room. It keeps what the cameras show of the room without people, and people's textures; what it
/// draws does not depend on what it drew before, nor on the number of threads.
#[derive(Clone, Debug)]
pub struct Renderer {
    setting: Setting,
    seed: u64,
    stage: Stage,
    lamps: Lamps,
    views: Vec<View>,
    figures: Vec<Figure>,
    /// Where in `figures` each person of the shot is.
    people: Vec<usize>,
    bins: Bins,
    bands: Vec<Band>,
    identity: Vec<u16>,
    outlines: Vec<Outline>,
    developer: Developer,
}

impl Renderer {
    /// A renderer of a room; `seed` distinguishes the noise of its sensors. What is not finite in the setting is left
    /// out.
    pub fn new(setting: &Setting, seed: u64) -> Self {
        Self {
            setting: setting.clone(),
            seed,
            stage: Stage::new(setting),
            lamps: Lamps::default(),
            views: Vec::new(),
            figures: Vec::new(),
            people: Vec::new(),
            bins: Bins::default(),
            bands: Vec::new(),
            identity: Vec::new(),
            outlines: Vec::new(),
            developer: Developer::new(),
        }
    }

    /// Takes a picture, keeping the memory of `picture`. People whose posture is not finite are not drawn, and lamps and
    /// gains that are not finite are dark. A camera without area gives an empty picture.
    ///
    /// The first picture of a camera takes longer, as does each of one that moves or whose light changes: the room is
    /// drawn anew.
    pub fn render(&mut self, shot: &Shot<'_>, picture: &mut Picture) {
        let (width, height) = (shot.camera.width, shot.camera.height);
        picture.resize(width, height);
        picture.range = shot.range;
        picture.sights.clear();
        if width == 0 || height == 0 {
            picture.sights.resize(shot.people.len(), super::Sight::default());
            return;
        }
        self.lamps.set(&self.setting, shot.lamps);
        let slot = shot.view % MOST_VIEWS;
        if self.views.len() <= slot {
            self.views.resize_with(slot + 1, View::default);
        }
        self.views[slot].update(
            &self.stage,
            &self.lamps,
            shot.lamps,
            shot.camera,
            shot.closing_pose,
        );
        self.find_figures(shot);
        self.pose_figures(shot);
        let turn = match shot.camera.model {
            CameraModel::Panorama(lens) => Some(lens.parameters().columns_per_turn as f32),
            _ => None,
        };
        self.bins.fill(&self.figures, &self.people, width, height, turn);
        self.expose(shot, turn, slot, picture);
        let identity = Identity {
            pixels: &self.identity,
            width,
            height,
            turn,
        };
        self.outlines.resize_with(self.people.len(), Outline::default);
        picture.sights.resize(shot.people.len(), super::Sight::default());
        let (figures, people) = (&self.figures, &self.people);
        let outlines = self.outlines.par_iter_mut().zip(people.par_iter()).enumerate();
        outlines
            .zip(picture.sights.par_iter_mut())
            .for_each(|((number, (outline, place)), sight)| {
                *sight = outline.sight(&figures[*place], number as u16 + 1, &identity);
            });
    }

    /// Finds everyone's figure, or makes one.
    fn find_figures(&mut self, shot: &Shot<'_>) {
        self.people.clear();
        for person in shot.people.iter().take(MOST_PEOPLE) {
            let free = |place: &usize| !self.people.contains(place);
            let known = (0..self.figures.len())
                .filter(free)
                .find(|place| self.figures[*place].is_of(person.looks));
            let place = known.unwrap_or_else(|| {
                let full = self.figures.len() >= MOST_FIGURES;
                let spare = if full {
                    (0..self.figures.len()).find(free)
                } else {
                    None
                };
                match spare {
                    Some(place) => {
                        self.figures[place] = Figure::new(person.looks);
                        place
                    }
                    None => {
                        self.figures.push(Figure::new(person.looks));
                        self.figures.len() - 1
                    }
                }
            });
            self.people.push(place);
        }
    }

    fn pose_figures(&mut self, shot: &Shot<'_>) {
        let (people, lamps) = (&self.people, &self.lamps);
        self.figures
            .par_iter_mut()
            .enumerate()
            .for_each(|(place, figure)| {
                if let Some(number) = people.iter().position(|own| *own == place) {
                    figure.pose(&shot.people[number], shot, lamps);
                }
            });
    }

    fn expose(&mut self, shot: &Shot<'_>, turn: Option<f32>, slot: usize, picture: &mut Picture) {
        let (width, height) = (picture.width, picture.height);
        self.developer.set(shot.noise);
        let gain = |value: f64| {
            if value.is_finite() {
                value.clamp(0.0, 1e6) as f32
            } else {
                0.0
            }
        };
        let how = Development {
            gains: shot
                .white_balance
                .map(|balance| gain(shot.exposure) * gain(balance)),
            range: shot.range,
            seed: mix(mix(self.seed ^ mix(shot.view as u64)) ^ shot.frame),
            width,
        };
        let bands = height.div_ceil(BAND_ROWS);
        self.bands.resize_with(bands.max(self.bands.len()), Band::default);
        self.identity.resize(width * height, 0);
        let scene = Scene {
            figures: &self.figures,
            people: &self.people,
            view: &self.views[slot],
            width,
            height,
            turn: turn.unwrap_or(0.0),
            times: self.times(),
        };
        let columns = width.div_ceil(2);
        let Picture {
            luma,
            chroma: [blues, reds],
            ..
        } = picture;
        let planes = luma
            .par_chunks_mut(BAND_ROWS * width)
            .zip(blues.par_chunks_mut(BAND_ROWS / 2 * columns))
            .zip(reds.par_chunks_mut(BAND_ROWS / 2 * columns));
        let memory = self
            .bands
            .par_iter_mut()
            .zip(self.identity.par_chunks_mut(BAND_ROWS * width));
        let (bins, developer) = (&self.bins, &self.developer);
        memory
            .zip(planes)
            .enumerate()
            .for_each(|(number, ((band, identity), ((luma, blues), reds)))| {
                band.draw(&scene, bins.band(number), number, identity);
                developer.develop(&how, number * BAND_ROWS, &band.light, luma, [blues, reds]);
            });
    }

    /// How often people are drawn while the shutter is open.
    fn times(&self) -> usize {
        let drawn = self
            .people
            .iter()
            .map(|place| &self.figures[*place])
            .filter(|figure| figure.drawn);
        let fastest = drawn.map(Figure::fastest_px).fold(0.0, f32::max);
        match fastest {
            fastest if fastest <= FAST_PX => SAMPLES,
            fastest if fastest <= 3.0 * FAST_PX => 2 * SAMPLES,
            _ => 4 * SAMPLES,
        }
    }
}
