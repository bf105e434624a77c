//! Mean shift: from where a head was to where its colours are now (Comaniciu, Ramesh and Meer 2000; Chen and Rui, section
//! IV.B).
//!
//! With the Epanechnikov profile the step goes to the weighted mean of the pixels, each weighing sqrt(q / p) of its colour:
//! colours that the model has and the place lacks pull. An ellipse is given by the [`Rectangle`] it touches from inside.

use crate::VisionError;
use crate::histogram::{BinPicture, Histogram};
use hearsight_core::Rectangle;
use serde::{Deserialize, Serialize};

/// How far and how long is searched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MeanShiftOptions {
    /// Most steps, 1 to 200, default 20.
    pub iterations: usize,
    /// A step shorter than this ends the search (epsilon), pixels, above 0, default 0.5.
    pub least_step_px: f32,
    /// Share by which larger and smaller sizes are tried, 0 to 0.5, default 0.1; 0 keeps the size.
    pub size_step: f32,
    /// Share of the best size in the new one, 0 to 1, default 0.1. Raising it follows sizes faster and less surely.
    pub size_share: f32,
    /// Most pixels read of an ellipse, at least 16, default 1024. Of larger ones every second (third, ...) row and column
    /// is read.
    pub pixels: u32,
}

impl Default for MeanShiftOptions {
    fn default() -> Self {
        Self {
            iterations: 20,
            least_step_px: 0.5,
            size_step: 0.1,
            size_share: 0.1,
            pixels: 1024,
        }
    }
}

impl MeanShiftOptions {
    /// # Errors
    /// [`VisionError::Parameter`] where a number is outside its range.
    pub fn validate(&self) -> Result<(), VisionError> {
        VisionError::within("iterations", self.iterations as f64, 1.0, 200.0, "1 to 200")?;
        VisionError::within(
            "least_step_px",
            self.least_step_px.into(),
            1e-3,
            100.0,
            "0.001 to 100",
        )?;
        VisionError::within("size_step", self.size_step.into(), 0.0, 0.5, "0 to 0.5")?;
        VisionError::within("size_share", self.size_share.into(), 0.0, 1.0, "0 to 1")?;
        VisionError::within("pixels", self.pixels.into(), 16.0, 1e9, "16 or more")
    }
}

/// Where the search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shifted {
    /// The ellipse.
    pub bounds: Rectangle,
    /// Bhattacharyya coefficient of its colours and the model's (rho), 0 to 1.
    pub coefficient: f32,
    /// Steps taken in all.
    pub iterations: usize,
}

/// Follows colours; owns its buffers.
#[derive(Clone, Debug)]
pub struct MeanShift {
    options: MeanShiftOptions,
    /// The model's bins that are not zero: nothing else counts.
    used: Vec<(u16, f32)>,
    /// Sums of the kernel by bin at the place read last.
    sums: Vec<f32>,
    /// By bin; of bins that the model has not always 0.
    ratios: Vec<f32>,
}

/// Least deviation that a colour search can have, pixels.
const LEAST_DEVIATION_PX: f64 = 2.0;

/// Pixels of an ellipse on the grid of a picture.
struct Grid {
    x: f32,
    y: f32,
    half_width: f32,
    half_height: f32,
    step: usize,
}

impl MeanShift {
    /// A search.
    ///
    /// # Errors
    /// [`VisionError::Parameter`] where an option is outside its range.
    pub fn new(options: MeanShiftOptions) -> Result<Self, VisionError> {
        options.validate()?;
        Ok(Self {
            options,
            used: Vec::new(),
            sums: Vec::new(),
            ratios: Vec::new(),
        })
    }

    /// Follows `model` from `start`, then adapts the size. None where the start shows none of the picture, or the model
    /// is of other bins or empty.
    pub fn follow(&mut self, picture: &BinPicture, model: &Histogram, start: &Rectangle) -> Option<Shifted> {
        if !self.load(picture, model) || model.is_zero() {
            return None;
        }
        let mut best = self.search(picture, start)?;
        let MeanShiftOptions {
            size_step,
            size_share,
            ..
        } = self.options;
        if size_step > 0.0 && size_share > 0.0 {
            let found = best;
            let mut factor = 1.0;
            for tried in [1.0 + size_step, 1.0 - size_step] {
                let resized = scaled(&found.bounds, tried);
                if let Some(other) = self.search(picture, &resized) {
                    best.iterations += other.iterations;
                    if other.coefficient > best.coefficient {
                        let iterations = best.iterations;
                        best = Shifted { iterations, ..other };
                        factor = tried;
                    }
                }
            }
            // The place of the best size, with most of the old size: h = share h_opt + (1 - share) h_prev.
            best.bounds = scaled(&best.bounds, (1.0 - size_share + size_share * factor) / factor);
        }
        Some(best)
    }

    /// The paper's loop at one size: weights, mean, halving while the likeness falls, end at a short step.
    fn search(&mut self, picture: &BinPicture, start: &Rectangle) -> Option<Shifted> {
        let mut bounds = *start;
        let mut coefficient = self.likeness(picture, &bounds)?;
        let mut iterations = 0;
        while iterations < self.options.iterations {
            iterations += 1;
            let Some((x, y)) = self.mean(picture, &bounds) else {
                break;
            };
            let (from_x, from_y) = bounds.centre();
            let mut offset = (x - from_x, y - from_y);
            let mut next = moved(&bounds, offset);
            let mut likeness = self.likeness(picture, &next).unwrap_or(0.0);
            let least = self.options.least_step_px;
            let long = |offset: (f32, f32)| offset.0.hypot(offset.1) >= least;
            while likeness < coefficient && long(offset) {
                offset = (0.5 * offset.0, 0.5 * offset.1);
                next = moved(&bounds, offset);
                likeness = self.likeness(picture, &next).unwrap_or(0.0);
            }
            if likeness < coefficient {
                break;
            }
            (bounds, coefficient) = (next, likeness);
            if !long(offset) {
                break;
            }
        }
        Some(Shifted {
            bounds,
            coefficient,
            iterations,
        })
    }

    /// Bhattacharyya coefficient of the colours in an ellipse and the model, 0 to 1; none where nothing of it is in the
    /// picture or the model has other bins.
    pub fn coefficient(
        &mut self,
        picture: &BinPicture,
        model: &Histogram,
        bounds: &Rectangle,
    ) -> Option<f32> {
        if !self.load(picture, model) {
            return None;
        }
        self.likeness(picture, bounds)
    }

    /// Takes a model in; false where it has other bins.
    fn load(&mut self, picture: &BinPicture, model: &Histogram) -> bool {
        let bins = picture.options().bins();
        self.used.clear();
        self.ratios.clear();
        if model.values().len() != bins {
            return false;
        }
        self.ratios.resize(bins, 0.0);
        self.used.reserve(bins);
        let values = (0_u16..).zip(model.values().iter().copied());
        self.used.extend(values.filter(|(_, value)| *value != 0.0));
        true
    }

    /// As [`Self::coefficient`], of the model that was taken in.
    fn likeness(&mut self, picture: &BinPicture, bounds: &Rectangle) -> Option<f32> {
        let total = self.read(picture, bounds)?;
        let sums = &self.sums;
        let sum: f32 = self
            .used
            .iter()
            .map(|(bin, value)| (sums[usize::from(*bin)] * value).sqrt())
            .sum();
        Some((sum / total.sqrt()).min(1.0))
    }

    /// Mean of the pixels, each by the root of model over place: the sums must be those of these bounds.
    fn mean(&mut self, picture: &BinPicture, bounds: &Rectangle) -> Option<(f32, f32)> {
        for (bin, value) in &self.used {
            let sum = self.sums[usize::from(*bin)];
            self.ratios[usize::from(*bin)] = if sum > 0.0 { (value / sum).sqrt() } else { 0.0 };
        }
        let grid = Grid::new(bounds, self.options.pixels, picture.size())?;
        let ratios = &self.ratios;
        let (mut sum, mut sum_x, mut sum_y) = (0.0_f32, 0.0_f32, 0.0_f32);
        grid.rows(picture, |y, _, first, row| {
            let (mut row_sum, mut row_x) = (0.0_f32, 0.0_f32);
            for (place, bin) in row.iter().enumerate().step_by(grid.step) {
                let weight = ratios[usize::from(*bin)];
                row_sum += weight;
                row_x += weight * (first + place) as f32;
            }
            sum += row_sum;
            sum_x += row_x - row_sum * grid.x;
            sum_y += row_sum * (y as f32 - grid.y);
        });
        let (x, y) = bounds.centre();
        (sum > 0.0).then(|| (x + sum_x / sum, y + sum_y / sum))
    }

    /// Sums of the kernel by bin; returns their total, none where it is nothing.
    fn read(&mut self, picture: &BinPicture, bounds: &Rectangle) -> Option<f32> {
        let grid = Grid::new(bounds, self.options.pixels, picture.size())?;
        self.sums.clear();
        self.sums.resize(picture.options().bins(), 0.0);
        let sums = &mut self.sums;
        let mut total = 0.0;
        grid.rows(picture, |_, axis, first, row| {
            let mut row_total = 0.0;
            for (place, bin) in row.iter().enumerate().step_by(grid.step) {
                let offset = ((first + place) as f32 - grid.x) / grid.half_width;
                let weight = (axis - offset * offset).max(0.0);
                sums[usize::from(*bin)] += weight;
                row_total += weight;
            }
            total += row_total;
        });
        (total > 0.0).then_some(total)
    }

    /// How unsure the place and half height of an ellipse at a maximum are: covariance of (x, y, half height), square
    /// pixels, the inverse of the curvature of -`sharpness` ln rho by finite differences, row by row.
    ///
    /// -ln rho is no log-likelihood, but grows like one: with a sharpness of 1 a head whose colours fit perfectly is unsure
    /// by nearly its own size. Raising it (above 0) trusts colours more.
    ///
    /// No deviation is below 2 px, and none above the ellipse's half height: where the likeness is flat or bends the other
    /// way it tells nothing. Half height is taken apart from the place.
    pub fn covariance(
        &mut self,
        picture: &BinPicture,
        model: &Histogram,
        bounds: &Rectangle,
        sharpness: f64,
    ) -> [[f64; 3]; 3] {
        let half = f64::from(0.5 * bounds.height).max(LEAST_DEVIATION_PX);
        let limits = (LEAST_DEVIATION_PX.powi(2), half * half);
        let loaded = self.load(picture, model);
        let step = (0.15 * half).max(1.0);
        let mut at = |x: f64, y: f64, size: f64| {
            let bounds = scaled(&moved(bounds, (x as f32, y as f32)), (1.0 + size / half) as f32);
            let likeness = self.likeness(picture, &bounds).filter(|_| loaded).unwrap_or(0.0);
            -sharpness * f64::from(likeness).max(1e-6).ln()
        };
        let middle = at(0.0, 0.0, 0.0);
        let mut second = |axis: usize| {
            let offset = |sign: f64| [0, 1, 2].map(|other| if other == axis { sign * step } else { 0.0 });
            let [a, b] = [offset(1.0), offset(-1.0)].map(|[x, y, size]| at(x, y, size));
            (a - 2.0 * middle + b) / (step * step)
        };
        let [xx, yy, ss] = [0, 1, 2].map(&mut second);
        let xy = (at(step, step, 0.0) - at(step, -step, 0.0) - at(-step, step, 0.0) + at(-step, -step, 0.0))
            / (4.0 * step * step);
        let variance = |curvature: f64| {
            if curvature > 0.0 {
                (1.0 / curvature).clamp(limits.0, limits.1)
            } else {
                limits.1
            }
        };
        // Along the axes of the curvature, so that limits hold in every direction.
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        let (sine, cosine) = angle.sin_cos();
        let along = variance(xx * cosine * cosine + 2.0 * xy * sine * cosine + yy * sine * sine);
        let across = variance(xx * sine * sine - 2.0 * xy * sine * cosine + yy * cosine * cosine);
        let shared = (along - across) * sine * cosine;
        [
            [along * cosine * cosine + across * sine * sine, shared, 0.0],
            [shared, along * sine * sine + across * cosine * cosine, 0.0],
            [0.0, 0.0, variance(ss)],
        ]
    }
}

impl Grid {
    fn new(bounds: &Rectangle, pixels: u32, (width, height): (usize, usize)) -> Option<Self> {
        if !bounds.is_finite() || bounds.width <= 0.0 || bounds.height <= 0.0 {
            return None;
        }
        let picture = Rectangle::new(0.0, 0.0, width as f32, height as f32);
        let seen = bounds
            .intersection(&picture)
            .area()
            .min(std::f32::consts::FRAC_PI_4 * bounds.area());
        let (x, y) = bounds.centre();
        Some(Self {
            x: x - 0.5,
            y: y - 0.5,
            half_width: 0.5 * bounds.width,
            half_height: 0.5 * bounds.height,
            step: ((seen / pixels as f32).sqrt().ceil() as usize).max(1),
        })
    }

    /// Calls `each` with the row, 1 - r^2 on the axis, the first column and the bins from there on, whatever is in the
    /// picture.
    fn rows(&self, picture: &BinPicture, mut each: impl FnMut(usize, f32, usize, &[u16])) {
        let (width, height) = picture.size();
        // Conversions of floats saturate, so what lies far outside is clipped.
        let grid = |first: f32| ((first.ceil().max(0.0) as usize).div_ceil(self.step)) * self.step;
        let end = |last: f32, limit: usize| ((last.floor() + 1.0).max(0.0) as usize).min(limit);
        for y in (grid(self.y - self.half_height)..end(self.y + self.half_height, height)).step_by(self.step)
        {
            let offset = (y as f32 - self.y) / self.half_height;
            let axis = (1.0 - offset * offset).max(0.0);
            let chord = self.half_width * axis.sqrt();
            let (first, end) = (grid(self.x - chord), end(self.x + chord, width));
            if first < end {
                each(
                    y,
                    axis,
                    first,
                    &picture.bins()[y * width + first..y * width + end],
                );
            }
        }
    }
}

fn moved(bounds: &Rectangle, (x, y): (f32, f32)) -> Rectangle {
    Rectangle {
        left: bounds.left + x,
        top: bounds.top + y,
        ..*bounds
    }
}

fn scaled(bounds: &Rectangle, factor: f32) -> Rectangle {
    let (x, y) = bounds.centre();
    Rectangle::from_centre(x, y, factor * bounds.width, factor * bounds.height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::histogram::{HistogramOptions, HistogramScratch};
    use hearsight_core::RgbView;

    fn head(x: f32, y: f32, half: f32) -> Rectangle {
        Rectangle::from_centre(x, y, 2.0 * half / 1.2, 2.0 * half)
    }

    /// A head of two colours before a wall of two others.
    fn picture(centre: (f32, f32), half: f32) -> BinPicture {
        let (width, height) = (160, 120);
        let data: Vec<u8> = (0..width * height)
            .flat_map(|i| {
                let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
                let (u, v) = ((x - centre.0) / (half / 1.2), (y - centre.1) / half);
                if u * u + v * v < 1.0 {
                    if v < -0.3 { [60, 40, 30] } else { [200, 150, 120] }
                } else if (i / 7) % 3 == 0 {
                    [120, 130, 140]
                } else {
                    [90, 110, 100]
                }
            })
            .collect();
        let mut bins = BinPicture::new(HistogramOptions::default()).unwrap();
        bins.compute(RgbView::new(width, height, &data).unwrap());
        bins
    }

    fn model(bins: &BinPicture, bounds: &Rectangle) -> Histogram {
        let mut histogram = Histogram::default();
        bins.histogram(bounds, &mut HistogramScratch::default(), &mut histogram);
        histogram
    }

    #[test]
    fn it_ends_on_the_head_from_half_a_head_away() {
        let truth = head(80.0, 60.0, 18.0);
        let bins = picture((80.0, 60.0), 18.0);
        let model = model(&bins, &truth);
        let mut shift = MeanShift::new(MeanShiftOptions::default()).unwrap();
        for (x, y) in [(90.0, 60.0), (72.0, 70.0), (80.0, 46.0), (80.0, 60.0)] {
            let found = shift.follow(&bins, &model, &head(x, y, 18.0)).unwrap();
            let (u, v) = found.bounds.centre();
            assert!((u - 80.0).hypot(v - 60.0) < 1.0, "{found:?}");
            assert!(found.coefficient > 0.97 && found.iterations <= 60);
            assert!((found.bounds.height - 36.0).abs() < 1.5);
        }
    }

    #[test]
    fn likeness_is_that_of_the_histogram() {
        let bins = picture((70.3, 61.7), 20.0);
        let model = model(&bins, &head(70.0, 60.0, 20.0));
        let mut shift = MeanShift::new(MeanShiftOptions::default()).unwrap();
        let mut other = Histogram::default();
        let place = head(76.2, 55.4, 17.0);
        bins.histogram(&place, &mut HistogramScratch::default(), &mut other);
        let found = shift.coefficient(&bins, &model, &place).unwrap();
        assert!((found - model.coefficient(&other)).abs() < 1e-4);
    }

    #[test]
    fn sizes_adapt_a_tenth_of_the_way() {
        let bins = picture((80.0, 60.0), 22.0);
        let model = model(&bins, &head(80.0, 60.0, 22.0));
        let mut shift = MeanShift::new(MeanShiftOptions::default()).unwrap();
        let mut bounds = head(80.0, 60.0, 26.0);
        let first = shift.follow(&bins, &model, &bounds).unwrap();
        assert!((first.bounds.height / 52.0 - 0.99).abs() < 1e-3, "{first:?}");
        for _ in 0..40 {
            bounds = shift.follow(&bins, &model, &bounds).unwrap().bounds;
        }
        assert!((bounds.height - 44.0).abs() < 3.0, "{bounds:?}");
    }

    #[test]
    fn the_covariance_is_bounded_and_wide_where_colours_tell_nothing() {
        let bins = picture((80.0, 60.0), 18.0);
        let truth = head(80.0, 60.0, 18.0);
        let model = model(&bins, &truth);
        let mut shift = MeanShift::new(MeanShiftOptions::default()).unwrap();
        let sure = shift.covariance(&bins, &model, &truth, 10.0);
        let blind = shift.covariance(&bins, &model, &head(30.0, 60.0, 18.0), 10.0);
        for axis in 0..3 {
            assert!(
                sure[axis][axis] >= 4.0 && sure[axis][axis] < 0.8 * blind[axis][axis],
                "{sure:?} {blind:?}"
            );
            assert!(blind[axis][axis] <= 18.0 * 18.0 + 1e-6);
        }
        assert!(sure[0][1].powi(2) < sure[0][0] * sure[1][1]);
    }

    #[test]
    fn nothing_to_see_is_none() {
        let bins = picture((80.0, 60.0), 18.0);
        let model = model(&bins, &head(80.0, 60.0, 18.0));
        let mut shift = MeanShift::new(MeanShiftOptions::default()).unwrap();
        for start in [
            head(-100.0, 60.0, 18.0),
            head(80.0, 60.0, 0.0),
            head(f32::NAN, 60.0, 18.0),
        ] {
            assert_eq!(shift.follow(&bins, &model, &start), None);
        }
        assert_eq!(
            shift.follow(&bins, &Histogram::default(), &head(80.0, 60.0, 18.0)),
            None
        );
        let tiny = shift.follow(&bins, &model, &head(80.0, 60.0, 0.4));
        assert!(tiny.is_none_or(|found| found.bounds.is_finite()));
        assert!(
            MeanShift::new(MeanShiftOptions {
                iterations: 0,
                ..MeanShiftOptions::default()
            })
            .is_err()
        );
    }
}
