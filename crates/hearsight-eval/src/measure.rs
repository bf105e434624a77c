//! How near a track is to a person: by overlap of boxes, by pixels, or by metres.

use hearsight_core::record::BoxRecord;

/// What distances are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Boxes: the distance is 1 - intersection over union, 0 to 1.
    Overlap,
    /// Points in a picture: the distance is in pixels.
    Pixels,
    /// Points in the world: the distance is in metres.
    Metres,
}

impl Measure {
    /// The usual gate: pairs farther apart than this are no match. An overlap of a half, 30 pixels, half a metre.
    pub const fn default_gate(self) -> f64 {
        match self {
            Self::Overlap | Self::Metres => 0.5,
            Self::Pixels => 30.0,
        }
    }

    /// Name of the unit of distances; empty for overlaps.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Overlap => "",
            Self::Pixels => "px",
            Self::Metres => "m",
        }
    }

    /// The distance where both places are of a kind that can be compared so, 0 to infinity.
    pub fn distance(self, one: &Place, other: &Place) -> Option<f64> {
        self.raw(one, other).map(|raw| self.distance_of(raw))
    }

    /// Whether a place can be compared so.
    pub fn can_use(self, place: &Place) -> bool {
        match (self, place) {
            (Self::Overlap, Place::Box(_)) | (Self::Metres, Place::World(_)) => true,
            (Self::Pixels, place) => !matches!(place, Place::World(_)),
            (Self::Overlap | Self::Metres, _) => false,
        }
    }

    /// What is kept for each pair: the overlap itself, not its distance, so that nothing is lost to rounding.
    pub(crate) fn raw(self, one: &Place, other: &Place) -> Option<f64> {
        match (self, one, other) {
            (Self::Overlap, Place::Box(one), Place::Box(other)) => Some(overlap(one, other)),
            (Self::Pixels, one, other) => {
                let ([u, v], [other_u, other_v]) = (one.pixel()?, other.pixel()?);
                Some(libm::sqrt((u - other_u).powi(2) + (v - other_v).powi(2)))
            }
            (Self::Metres, Place::World(one), Place::World(other)) => {
                let squares = one.iter().zip(other).map(|(a, b)| (a - b).powi(2));
                Some(libm::sqrt(squares.sum()))
            }
            _ => None,
        }
    }

    pub(crate) fn distance_of(self, raw: f64) -> f64 {
        match self {
            Self::Overlap => 1.0 - raw,
            Self::Pixels | Self::Metres => raw,
        }
    }

    /// Similarity as TrackEval has it, 0 to 1: the overlap, or 1 - distance / (2 gate) so that the gate is at a half.
    pub(crate) fn similarity_of(self, raw: f64, gate: f64) -> f64 {
        match self {
            Self::Overlap => raw,
            Self::Pixels | Self::Metres => (1.0 - raw / (2.0 * gate)).max(0.0),
        }
    }
}

/// Where somebody is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A box in a picture, pixels.
    Box(BoxRecord),
    /// A point in a picture, column and row, pixels.
    Pixel([f64; 2]),
    /// A point in the world, metres.
    World([f64; 3]),
}

impl Place {
    /// The point in the picture. Of a box it is the mouth where the box is a head: half the width, three quarters of
    /// the height. None for a point in the world.
    pub fn pixel(&self) -> Option<[f64; 2]> {
        match self {
            Self::Box(head) => Some([head.left + head.width / 2.0, head.top + 0.75 * head.height]),
            Self::Pixel(pixel) => Some(*pixel),
            Self::World(_) => None,
        }
    }

    /// The point with as many coordinates as it has, the others zero: pixels or metres.
    pub fn coordinates(&self) -> [f64; 3] {
        match (self, self.pixel()) {
            (Self::World(point), _) => *point,
            (_, Some([u, v])) => [u, v, 0.0],
            (_, None) => [0.0; 3],
        }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Box(b) => [b.left, b.top, b.width, b.height].iter().all(|x| x.is_finite()),
            Self::Pixel(pixel) => pixel.iter().all(|x| x.is_finite()),
            Self::World(point) => point.iter().all(|x| x.is_finite()),
        }
    }
}

/// Intersection over union, 0 to 1; 0 for a box without area. Most boxes are apart, which is known soon.
fn overlap(one: &BoxRecord, other: &BoxRecord) -> f64 {
    let common = |one: [f64; 2], other: [f64; 2]| {
        let end = if one[1] < other[1] { one[1] } else { other[1] };
        let start = if one[0] > other[0] { one[0] } else { other[0] };
        end - start
    };
    let across = |b: &BoxRecord| [b.left, b.left + b.width];
    let down = |b: &BoxRecord| [b.top, b.top + b.height];
    let width = common(across(one), across(other));
    // What is not a number is no overlap either.
    if width.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
        return 0.0;
    }
    let height = common(down(one), down(other));
    let intersection = width * height;
    if intersection.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
        return 0.0;
    }
    let area = |b: &BoxRecord| {
        let ([left, right], [top, bottom]) = (across(b), down(b));
        (right - left) * (bottom - top)
    };
    let ratio = intersection / (area(one) + area(other) - intersection);
    if ratio.is_finite() { ratio } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(left: f64, top: f64, width: f64, height: f64) -> Place {
        Place::Box(BoxRecord {
            left,
            top,
            width,
            height,
        })
    }

    #[test]
    fn boxes_overlap_by_intersection_over_union() {
        let distance = |one, other| Measure::Overlap.distance(&one, &other).unwrap();
        let unit = head(0.0, 0.0, 2.0, 2.0);
        assert_eq!(distance(unit, unit), 0.0);
        assert_eq!(distance(unit, head(1.0, 0.0, 2.0, 2.0)), 1.0 - 2.0 / 6.0);
        for apart in [
            head(2.0, 0.0, 1.0, 1.0),
            head(1.0, 1.0, 0.0, 5.0),
            head(1.0, 1.0, -1.0, -1.0),
            head(1e308, 1e308, 1e308, 1e308),
        ] {
            assert_eq!(distance(unit, apart), 1.0, "{apart:?}");
        }
    }

    #[test]
    fn only_places_of_one_kind_are_compared() {
        let (pixel, point) = (Place::Pixel([3.0, 4.0]), Place::World([1.0, 2.0, 2.0]));
        let mouth = head(-1.0, -3.0, 2.0, 4.0);
        assert_eq!(Measure::Pixels.distance(&mouth, &pixel), Some(5.0));
        assert_eq!(
            Measure::Metres.distance(&point, &Place::World([0.0; 3])),
            Some(3.0)
        );
        assert_eq!(Measure::Overlap.distance(&mouth, &pixel), None);
        assert_eq!(Measure::Pixels.distance(&point, &pixel), None);
        assert!(!Measure::Metres.can_use(&pixel));
    }
}
