//! `<camera>.mp4`: the camera's picture with heads, identities by colour, who speaks, and what is heard where.

use super::{Sink, SinkContext, SinkError, SinkInfo, Tick};
use crate::summary::Summary;
use hearsight_core::record::{TrackPhase, TrackRecord, ViewRecord};
use hearsight_core::{Rectangle, RgbView};
use hearsight_media::{Canvas, VideoWriter, VideoWriterOptions, identity_color};
use hearsight_systems::Bars;
use std::path::PathBuf;

pub(super) const INFO: SinkInfo = SinkInfo {
    name: "overlay",
    file: "<camera>.mp4",
    summary: "Video of each camera with heads, identities by colour, who speaks, and the correlation of sound.",
    default: false,
    open,
};

/// Part of the picture's height that the strip of correlation takes, at the bottom.
const STRIP_PART: f32 = 0.12;
/// Thickness of a head's outline, pixels.
const OUTLINE_PX: f32 = 1.5;

fn open(context: &SinkContext<'_>) -> Result<Box<dyn Sink>, SinkError> {
    let videos = context.room.cameras.iter().map(|camera| {
        let path = context.directory.join(format!("{}.mp4", camera.name));
        let options = VideoWriterOptions {
            interval: camera.interval,
            ..VideoWriterOptions::default()
        };
        let writer = VideoWriter::create(&path, camera.width, camera.height, &options)
            .map_err(|error| SinkError::new(&path, error))?;
        Ok(Video {
            camera: camera.name.clone(),
            path,
            writer: Some(writer),
        })
    });
    Ok(Box::new(Overlay {
        videos: videos.collect::<Result<_, _>>()?,
        rgb: Vec::new(),
    }))
}

struct Overlay {
    /// One a camera, in the order of the room.
    videos: Vec<Video>,
    rgb: Vec<u8>,
}

struct Video {
    camera: String,
    path: PathBuf,
    writer: Option<VideoWriter>,
}

impl Sink for Overlay {
    fn write(&mut self, tick: Tick<'_>) -> Result<(), SinkError> {
        for (number, (video, observed)) in self.videos.iter_mut().zip(&tick.moment.video).enumerate() {
            let (Some(frame), Some(writer)) = (observed.get(), video.writer.as_mut()) else {
                continue;
            };
            self.rgb.clone_from(&frame.rgb);
            if let Some(mut canvas) = Canvas::new(frame.width, frame.height, &mut self.rgb) {
                draw_strip(&mut canvas, tick.system.correlation_strip(number));
                draw_bars(&mut canvas, tick.system.bars(number));
                for track in &tick.scene.tracks {
                    for view in track.views.iter().filter(|view| view.camera == video.camera) {
                        draw_head(&mut canvas, track, view);
                    }
                }
            }
            let picture = RgbView {
                width: frame.width,
                height: frame.height,
                data: &self.rgb,
            };
            writer
                .write(frame.time, picture)
                .map_err(|error| SinkError::new(&video.path, error))?;
        }
        Ok(())
    }

    fn finish(&mut self, _: &Summary) -> Result<(), SinkError> {
        let mut result = Ok(());
        for video in &mut self.videos {
            let finished = video.writer.take().map_or(Ok(()), VideoWriter::finish);
            result = result.and(finished.map_err(|error| SinkError::new(&video.path, error)));
        }
        result
    }
}

/// The correlation of sound over the columns, at the bottom of the picture.
fn draw_strip(canvas: &mut Canvas<'_>, strip: &[f32]) {
    if strip.is_empty() {
        return;
    }
    let (width, height) = (canvas.width() as f32, canvas.height() as f32);
    let area = Rectangle::new(0.0, height * (1.0 - STRIP_PART), width, height * STRIP_PART);
    canvas.fill(&area, [0, 0, 0], 0.6);
    canvas.strip(&area, strip, (0.0, 1.0), [120, 230, 120]);
}

/// What sound alone says in red, what all together say in green (Chen and Rui, figure 5).
fn draw_bars(canvas: &mut Canvas<'_>, bars: Bars) {
    let height = canvas.height() as f32;
    for (column, color) in [(bars.sound, [230, 40, 40]), (bars.fused, [40, 210, 60])] {
        if let Some(column) = column {
            canvas.line((column, 0.0), (column, height), 2.0, color);
        }
    }
}

/// A head with its number; dashed corners where it is hidden, a mark beside it where it speaks.
fn draw_head(canvas: &mut Canvas<'_>, track: &TrackRecord, view: &ViewRecord) {
    let color = identity_color(track.id);
    let head = Rectangle::new(
        view.head.left as f32,
        view.head.top as f32,
        view.head.width as f32,
        view.head.height as f32,
    );
    match track.phase {
        TrackPhase::Visible if track.speaking => canvas.outline(&head, 2.0 * OUTLINE_PX, color),
        TrackPhase::Visible => canvas.outline(&head, OUTLINE_PX, color),
        TrackPhase::Occluded => draw_corners(canvas, &head, color),
    }
    let label = if track.speaking {
        format!("{} speaks", track.id)
    } else {
        track.id.to_string()
    };
    canvas.label(head.left, head.top - 10.0, 1, [255, 255, 255], color, &label);
    if track.speaking {
        let (x, _) = head.centre();
        let radius = (head.width / 6.0).max(3.0);
        canvas.ellipse(
            (x, head.top - 16.0 - radius),
            (radius, radius),
            0.0,
            2.0,
            [255, 220, 0],
        );
    }
}

fn draw_corners(canvas: &mut Canvas<'_>, head: &Rectangle, color: hearsight_media::Color) {
    let (across, down) = (head.width / 4.0, head.height / 4.0);
    for (x, toward_x) in [(head.left, across), (head.right(), -across)] {
        for (y, toward_y) in [(head.top, down), (head.bottom(), -down)] {
            canvas.line((x, y), (x + toward_x, y), OUTLINE_PX, color);
            canvas.line((x, y), (x, y + toward_y), OUTLINE_PX, color);
        }
    }
}
