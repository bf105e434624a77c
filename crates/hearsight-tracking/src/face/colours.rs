//! The likelihood of a face by its colours: four sub-regions, each against its reference, the background attenuated.
//!
//! Only the surroundings of a face are binned, so that a large picture costs no more than the faces in it.

use hearsight_core::{Rectangle, RgbView};
use hearsight_vision::VisionError;
use hearsight_vision::histogram::{BinPicture, Histogram, HistogramOptions, HistogramScratch, Similarity};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A sub-region of a face (section 3.2). Where exactly the paper does not say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SubRegion {
    /// The band of the eyes, in the box.
    Eyes,
    /// Nose, mouth and chin, in the box.
    LowerFace,
    /// Forehead and hair, across the box's upper edge.
    ForeheadHair,
    /// Neck and chest, below the box.
    UpperTorso,
}

impl SubRegion {
    /// All of them, in the order of models and weights.
    pub const ALL: [Self; 4] = [Self::Eyes, Self::LowerFace, Self::ForeheadHair, Self::UpperTorso];

    /// Middle below the face's and size, as shares of the face's width: (down, wide, high).
    const fn proportions(self) -> (f32, f32, f32) {
        match self {
            Self::Eyes => (-0.14, 0.78, 0.30),
            Self::LowerFace => (0.24, 0.60, 0.44),
            Self::ForeheadHair => (-0.55, 0.80, 0.44),
            Self::UpperTorso => (1.30, 1.60, 1.00),
        }
    }

    /// Where it is for a face of `width` pixels at (x, y).
    pub fn region(self, x: f32, y: f32, width: f32) -> Rectangle {
        let (down, wide, high) = self.proportions();
        Rectangle::from_centre(x, y + down * width, wide * width, high * width)
    }
}

/// Whose histograms lose the colours of the background (eqs. 18 and 19).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Attenuation {
    /// Nobody's.
    Off,
    /// The reference's alone, corrected: attenuating both cancels out (erratum 10; Ning and others 2012). The default.
    Reference,
}

/// How colours are compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ColourSettings {
    /// Bins a channel (N_h), 2 to 32. Default 8; the paper does not say.
    pub bins: u8,
    /// Weights of eyes, lower face, forehead and hair, upper torso (w_h), each from 0, one above. Default 0.3, 0.3, 0.2,
    /// 0.2.
    pub weights: [f32; 4],
    /// Variance of the distance (sigma_color^2), above 0. Default 0.025 (Perez, Vermaak and Blake: lambda = 20).
    pub variance: f32,
    /// Whose histograms lose the colours of the background.
    pub attenuation: Attenuation,
    /// Time over which the reference follows what is detected, seconds, above 0. Default 20.
    pub adaptation_s: f64,
}

impl Default for ColourSettings {
    fn default() -> Self {
        Self {
            bins: 8,
            weights: [0.3, 0.3, 0.2, 0.2],
            variance: 1.0 / 40.0,
            attenuation: Attenuation::Reference,
            adaptation_s: 20.0,
        }
    }
}

impl ColourSettings {
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        let wrong = |name, value: f64, allowed| Err(VisionError::Parameter { name, value, allowed });
        if !(2..=32).contains(&self.bins) {
            return wrong("bins", self.bins.into(), "2 to 32");
        }
        let sum: f32 = self.weights.iter().sum();
        if !(self.weights.iter().all(|weight| *weight >= 0.0) && sum > 0.0 && sum.is_finite()) {
            return wrong("weights", sum.into(), "none below 0, one above");
        }
        if !(self.variance > 0.0 && self.variance.is_finite()) {
            return wrong("variance", self.variance.into(), "above 0");
        }
        if !(self.adaptation_s > 0.0 && self.adaptation_s.is_finite()) {
            return wrong("adaptation_s", self.adaptation_s, "above 0");
        }
        Ok(())
    }
}

/// Reads and compares colours around one face after the other, with the buffers that takes.
pub(super) struct FaceColours {
    settings: ColourSettings,
    bins: BinPicture,
    part: Vec<u8>,
    origin: (f32, f32),
    counts: Vec<u32>,
    attenuated: [Histogram; 4],
    values: Vec<f32>,
    regions: Vec<Rectangle>,
    similarities: Vec<Similarity>,
    scratch: HistogramScratch,
}

/// Most pixels read of a sub-region.
const PIXELS: u32 = 512;
/// Distance of a sub-region of which nothing is in the picture: it says neither yes nor no.
const UNSEEN: f32 = 0.5;

impl FaceColours {
    pub(super) fn new(settings: ColourSettings) -> Result<Self, VisionError> {
        settings.validate()?;
        let options = HistogramOptions {
            red: settings.bins,
            green: settings.bins,
            blue: settings.bins,
            pixels: PIXELS,
        };
        Ok(Self {
            settings,
            bins: BinPicture::new(options)?,
            part: Vec::new(),
            origin: (0.0, 0.0),
            counts: Vec::new(),
            attenuated: Default::default(),
            values: Vec::new(),
            regions: Vec::new(),
            similarities: Vec::new(),
            scratch: HistogramScratch::default(),
        })
    }

    /// Bins the surroundings of a face, `reach` face widths around it and more below; false where they are outside of the
    /// picture.
    pub(super) fn look(&mut self, picture: RgbView<'_>, face: &Rectangle, reach: f32) -> bool {
        let around = Rectangle::new(
            face.left - reach * face.width,
            face.top - (reach + 0.6) * face.width,
            face.width * (1.0 + 2.0 * reach),
            face.width * (2.0 * reach + 3.2),
        );
        let clip = |value: f32, most: usize| (value.max(0.0) as usize).min(most);
        let (left, top) = (clip(around.left, picture.width), clip(around.top, picture.height));
        let right = clip(around.right().ceil(), picture.width);
        let bottom = clip(around.bottom().ceil(), picture.height);
        if right <= left || bottom <= top {
            return false;
        }
        self.part.clear();
        for row in top..bottom {
            self.part
                .extend_from_slice(&picture.row(row)[3 * left..3 * right]);
        }
        self.origin = (left as f32, top as f32);
        RgbView::new(right - left, bottom - top, &self.part).is_some_and(|part| {
            self.bins.compute(part);
            true
        })
    }

    fn local(&self, region: Rectangle) -> Rectangle {
        Rectangle::new(
            region.left - self.origin.0,
            region.top - self.origin.1,
            region.width,
            region.height,
        )
    }

    /// The colours of one sub-region into `histogram`; returns the share of it that was seen.
    pub(super) fn read(&mut self, region: Rectangle, histogram: &mut Histogram) -> f32 {
        let region = self.local(region);
        self.bins.histogram(&region, &mut self.scratch, histogram)
    }

    /// Prepares references for comparison: with the colours of the immediate background of `face` attenuated.
    pub(super) fn refer(&mut self, model: &[Histogram; 4], face: &Rectangle) {
        if self.settings.attenuation == Attenuation::Off {
            for (attenuated, reference) in self.attenuated.iter_mut().zip(model) {
                attenuated.clone_from(reference);
            }
            return;
        }
        self.count_background(face);
        // The least count above zero; a bin that the background does not have keeps all (erratum 10).
        let least = self
            .counts
            .iter()
            .copied()
            .filter(|count| *count > 0)
            .min()
            .unwrap_or(0);
        for (attenuated, reference) in self.attenuated.iter_mut().zip(model) {
            self.values.clear();
            let share = |count: u32| {
                if count == 0 {
                    1.0
                } else {
                    least as f32 / count as f32
                }
            };
            let values = reference.values().iter().zip(&self.counts);
            self.values
                .extend(values.map(|(value, count)| value * share(*count)));
            let total: f32 = self.values.iter().sum();
            // All of its colours are in the background: better compare all than nothing.
            let scale = if total > 1e-6 { 1.0 / total } else { 0.0 };
            attenuated.clone_from(reference);
            if scale > 0.0 {
                attenuated.set_scaled(&self.values, scale);
            }
        }
    }

    /// Counts the colours beside and above the head: half a face wide on each side, down to the chin.
    fn count_background(&mut self, face: &Rectangle) {
        self.counts.clear();
        self.counts.resize(self.bins.options().bins(), 0);
        let (x, y) = face.centre();
        let width = face.width;
        let outer = self.local(Rectangle::from_centre(
            x,
            y - 0.35 * width,
            2.4 * width,
            1.7 * width,
        ));
        let head = self.local(Rectangle::from_centre(
            x,
            y - 0.2 * width,
            1.3 * width,
            1.4 * width,
        ));
        let (across, down) = self.bins.size();
        let span =
            |start: f32, end: f32, most: usize| (start.max(0.0) as usize)..(end.max(0.0) as usize).min(most);
        for row in span(outer.top, outer.bottom(), down) {
            for column in span(outer.left, outer.right(), across) {
                let is_head = row as f32 >= head.top && (head.left..head.right()).contains(&(column as f32));
                if !is_head {
                    self.counts[usize::from(self.bins.bins()[row * across + column])] += 1;
                }
            }
        }
    }

    /// The weighted distances of eq. 16 between faces and the references prepared last, 0 to 1, one a face.
    pub(super) fn distances(&mut self, faces: [&[f32]; 3], distances: &mut Vec<f32>) {
        let [x, y, width] = faces;
        distances.clear();
        distances.resize(x.len(), 0.0);
        let total: f32 = self.settings.weights.iter().sum();
        for (place, sub_region) in SubRegion::ALL.into_iter().enumerate() {
            let weight = self.settings.weights[place] / total;
            if weight == 0.0 {
                continue;
            }
            let states = x.iter().zip(y).zip(width);
            self.regions.clear();
            for ((x, y), width) in states {
                let region = self.local(sub_region.region(*x, *y, *width));
                self.regions.push(region);
            }
            self.bins.score_ellipses(
                &self.regions,
                &self.attenuated[place],
                &mut self.scratch,
                &mut self.similarities,
            );
            for (distance, similarity) in distances.iter_mut().zip(&self.similarities) {
                let seen = similarity.inside.clamp(0.0, 1.0);
                *distance += weight * (seen * (1.0 - similarity.coefficient) + (1.0 - seen) * UNSEEN);
            }
        }
    }

    /// ln of eq. 17.
    pub(super) fn log_likelihood(&self, distance: f32) -> f64 {
        f64::from(-distance / (2.0 * self.settings.variance))
    }

    /// Bins of a histogram.
    pub(super) fn bins(&self) -> usize {
        self.bins.options().bins()
    }

    pub(super) fn settings(&self) -> &ColourSettings {
        &self.settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A face on a wall: skin, dark hair, a red shirt; the wall has the shirt's red too.
    fn picture(wall: [u8; 3]) -> Vec<u8> {
        let mut rgb = wall.repeat(200 * 200);
        let mut fill = |region: Rectangle, colour: [u8; 3]| {
            for y in region.top.max(0.0) as usize..(region.bottom() as usize).min(200) {
                for x in region.left.max(0.0) as usize..(region.right() as usize).min(200) {
                    rgb[3 * (y * 200 + x)..][..3].copy_from_slice(&colour);
                }
            }
        };
        fill(Rectangle::new(60.0, 110.0, 80.0, 90.0), [200, 30, 40]);
        fill(Rectangle::new(80.0, 50.0, 40.0, 60.0), [210, 160, 130]);
        fill(Rectangle::new(80.0, 40.0, 40.0, 20.0), [40, 30, 20]);
        rgb
    }

    const FACE: (f32, f32, f32) = (100.0, 80.0, 40.0);

    fn learnt(colours: &mut FaceColours, rgb: &[u8]) -> [Histogram; 4] {
        let (x, y, width) = FACE;
        let view = RgbView::new(200, 200, rgb).unwrap();
        assert!(colours.look(view, &Rectangle::from_centre(x, y, width, width), 1.0));
        SubRegion::ALL.map(|region| {
            let mut histogram = Histogram::default();
            colours.read(region.region(x, y, width), &mut histogram);
            histogram
        })
    }

    #[test]
    fn the_face_is_nearest_to_its_own_colours() {
        let rgb = picture([90, 110, 140]);
        let mut colours = FaceColours::new(ColourSettings::default()).unwrap();
        let model = learnt(&mut colours, &rgb);
        let (x, y, width) = FACE;
        let face = Rectangle::from_centre(x, y, width, width);
        colours.refer(&model, &face);
        let mut distances = Vec::new();
        let xs = [x, x + 20.0, x, x, x];
        let ys = [y, y, y + 15.0, y, y];
        let widths = [width, width, width, 0.6 * width, 1.5 * width];
        colours.distances([&xs, &ys, &widths], &mut distances);
        println!("{distances:?}");
        assert!(distances[0] < 0.1);
        assert!(
            distances[1..]
                .iter()
                .all(|distance| *distance > distances[0] + 0.04)
        );
    }

    #[test]
    fn colours_of_the_background_lose_their_say() {
        let wall = [200, 30, 40];
        let rgb = picture(wall);
        let mut colours = FaceColours::new(ColourSettings::default()).unwrap();
        let mut model = learnt(&mut colours, &rgb);
        // A reference that is half skin, half wall keeps the skin.
        let bin = |colour: [u8; 3]| {
            colour
                .iter()
                .fold(0, |bin, value| bin * 8 + usize::from(*value) * 8 / 256)
        };
        let mut values = vec![0.0; 512];
        (values[bin(wall)], values[bin([210, 160, 130])]) = (0.5, 0.5);
        model[0] = Histogram::new(values).unwrap();
        let (x, y, width) = FACE;
        let face = Rectangle::from_centre(x, y, width, width);
        colours.refer(&model, &face);
        // A strip of hair is the rarest colour of the background, a twentieth of the wall: so much of the wall is left.
        assert!(colours.attenuated[0].values()[bin([210, 160, 130])] > 0.94);
        // All of the shirt is like the wall: it is compared all the same.
        assert!((colours.attenuated[3].values().iter().sum::<f32>() - 1.0).abs() < 1e-3);
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let wrong = ColourSettings {
            weights: [0.0; 4],
            ..ColourSettings::default()
        };
        assert!(
            FaceColours::new(wrong)
                .err()
                .unwrap()
                .to_string()
                .contains("weights")
        );
    }
}
