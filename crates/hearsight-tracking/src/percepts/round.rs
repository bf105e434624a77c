//! Pictures that go all round: what lies at one edge goes on at the other.
//!
//! Such a picture is widened by a margin on both sides that repeats the other side, so that nobody is cut by the seam:
//! whatever looks at regions, outlines or colours needs to know nothing of it. Places are kept in the widened picture;
//! people who leave its middle turn are moved by one turn ([`crate::tracker::ViewTracker`]).

use hearsight_core::camera::{Camera, CameraModel, Panorama, PanoramaParameters};
use hearsight_core::{Rectangle, VideoFrame};

/// One turn of a widened picture, columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Columns of a full turn: the width of the picture as it came.
    pub columns: usize,
    /// Columns that are repeated on each side.
    pub margin: usize,
}

/// Widens pictures that go all round; owns the widened one.
#[derive(Clone, Debug)]
pub struct RoundPicture {
    turn: Turn,
    frame: VideoFrame,
}

impl Turn {
    /// The turn of a camera whose pictures go all round; none of others.
    pub fn of(camera: &Camera) -> Option<Self> {
        let CameraModel::Panorama(lens) = &camera.model else {
            return None;
        };
        let columns = camera.width;
        // A column more or less is nothing that anybody sees.
        let round = (lens.parameters().columns_per_turn - columns as f64).abs() < 1.0;
        (round && columns >= 32).then_some(Self {
            columns,
            margin: (columns / 10).clamp(16, 400),
        })
    }

    /// Width of the widened picture.
    pub fn widened(&self) -> usize {
        self.columns + 2 * self.margin
    }

    /// The camera of the widened picture.
    pub fn widen(&self, camera: &Camera) -> Camera {
        let mut wide = *camera;
        wide.width = self.widened();
        if let CameraModel::Panorama(lens) = &camera.model {
            let old = lens.parameters();
            let shifted = Panorama::new(PanoramaParameters {
                centre_px: [old.centre_px[0] + self.margin as f64, old.centre_px[1]],
                ..*old
            });
            if let Ok(shifted) = shifted {
                wide.model = CameraModel::Panorama(shifted);
            }
        }
        wide
    }

    /// By how many columns a place must be moved to lie in the middle turn of the widened picture: a whole turn or nothing.
    pub fn shift(&self, column: f32) -> f32 {
        let (columns, margin) = (self.columns as f32, self.margin as f32);
        if column.is_finite() {
            -columns * ((column - margin) / columns).floor()
        } else {
            0.0
        }
    }

    /// A column of the widened picture in the picture as it came.
    pub fn narrow(&self, column: f32) -> f32 {
        column + self.shift(column) - self.margin as f32
    }

    /// A box of the widened picture in the picture as it came; its middle is in the picture.
    pub fn narrow_box(&self, head: &Rectangle) -> Rectangle {
        let (middle, _) = head.centre();
        Rectangle {
            left: head.left + self.narrow(middle) - middle,
            ..*head
        }
    }
}

impl RoundPicture {
    /// A widener of pictures of this turn.
    pub fn new(turn: Turn) -> Self {
        Self {
            turn,
            frame: VideoFrame::default(),
        }
    }

    /// Its turn.
    pub fn turn(&self) -> Turn {
        self.turn
    }

    /// The picture with both margins; the picture itself where its width is not that of the turn.
    pub fn widen<'a>(&'a mut self, frame: &'a VideoFrame) -> &'a VideoFrame {
        let Turn { columns, margin } = self.turn;
        let whole =
            frame.rgb.len() == 3 * columns * frame.height && frame.luma.len() == columns * frame.height;
        if frame.width != columns || !whole {
            return frame;
        }
        let wide = &mut self.frame;
        (wide.time, wide.number) = (frame.time, frame.number);
        (wide.width, wide.height) = (self.turn.widened(), frame.height);
        repeat_edges(&frame.rgb, 3 * columns, 3 * margin, &mut wide.rgb);
        repeat_edges(&frame.luma, columns, margin, &mut wide.luma);
        wide
    }
}

fn repeat_edges(from: &[u8], row: usize, margin: usize, to: &mut Vec<u8>) {
    to.clear();
    for row in from.chunks_exact(row.max(1)) {
        to.extend_from_slice(&row[row.len() - margin..]);
        to.extend_from_slice(row);
        to.extend_from_slice(&row[..margin]);
    }
}

/// A rectangle moved by whole turns so that it is as near to another as can be.
pub(crate) fn beside(own: &Rectangle, other: &Rectangle, turn_px: f32) -> Rectangle {
    if turn_px <= 0.0 {
        return *own;
    }
    let turns = ((other.centre().0 - own.centre().0) / turn_px).round();
    let shift = if turns.is_finite() { turns * turn_px } else { 0.0 };
    Rectangle {
        left: own.left + shift,
        ..*own
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hearsight_core::{Pose, WorldPoint};

    fn camera() -> Camera {
        Camera {
            model: CameraModel::Panorama(
                Panorama::new(PanoramaParameters {
                    columns_per_turn: 200.0,
                    focal_px: 32.0,
                    centre_px: [99.5, 20.0],
                })
                .unwrap(),
            ),
            pose: Pose::looking_at(WorldPoint::new(0.0, 0.0, 1.0), WorldPoint::new(1.0, 0.0, 1.0)).unwrap(),
            width: 200,
            height: 40,
        }
    }

    #[test]
    fn margins_repeat_the_other_side_and_columns_return() {
        let turn = Turn::of(&camera()).unwrap();
        assert_eq!((turn.columns, turn.margin, turn.widened()), (200, 20, 240));
        let frame = VideoFrame {
            width: 200,
            height: 2,
            rgb: (0..1200).map(|k| (k % 600 / 3) as u8).collect(),
            luma: (0..400).map(|k| (k % 200) as u8).collect(),
            ..VideoFrame::default()
        };
        let mut round = RoundPicture::new(turn);
        let wide = round.widen(&frame);
        assert_eq!((wide.width, wide.rgb.len(), wide.luma.len()), (240, 1440, 480));
        for column in 0..240 {
            let narrow = turn.narrow(column as f32) as u8;
            assert_eq!(wide.luma[240 + column], narrow, "{column}");
            assert_eq!(wide.rgb[3 * (240 + column)], narrow);
        }
        assert_eq!(turn.shift(19.0), 200.0);
        assert_eq!(turn.shift(20.0), 0.0);
        assert_eq!(turn.shift(220.0), -200.0);
        let box_ = Rectangle::new(10.0, 5.0, 8.0, 8.0);
        assert_eq!(turn.narrow_box(&box_).left, 190.0);
    }

    #[test]
    fn the_widened_camera_sees_the_same_directions() {
        let (own, turn) = (camera(), Turn::of(&camera()).unwrap());
        let wide = turn.widen(&own);
        for column in [0.0, 70.0, 199.0] {
            let ray = |camera: &Camera, u: f64| {
                let ray = camera.ray(hearsight_core::DistortedPixel::new(u, 12.0)).unwrap();
                ray.direction.into_inner()
            };
            let apart = ray(&own, column) - ray(&wide, column + 20.0);
            assert!(apart.norm() < 1e-9);
            let apart = ray(&own, column) - ray(&wide, column + 220.0);
            assert!(apart.norm() < 1e-9, "also in the margin");
        }
    }

    #[test]
    fn what_is_beside_is_beside_across_the_seam() {
        let (first, second) = (
            Rectangle::new(20.0, 0.0, 10.0, 10.0),
            Rectangle::new(214.0, 0.0, 10.0, 10.0),
        );
        assert_eq!(beside(&first, &second, 200.0).left, 220.0);
        assert_eq!(beside(&second, &first, 200.0).left, 14.0);
        assert_eq!(beside(&second, &first, 0.0), second);
    }
}
