//! A little room that is made up: two people walk to and fro and take turns in talking, before a camera midway between
//! two microphones. Real pictures and real samples come out, and the truth beside them.
//!
//! World: metres, the camera at (0, 0, 1.4) looks along y; x goes to the right of the picture.

mod painter;
mod voices;
mod world;

use hearsight::core::{Instant, RgbView, Span};
use hearsight::media::{VideoWriter, VideoWriterOptions};
use miette::{Context, IntoDiagnostic};
use std::path::{Path, PathBuf};

pub(crate) use world::{FRAMES_PER_SECOND, MICROPHONES_M, World};

/// Quality of the made-up video, 1 (best) to 63.
const QUALITY: u8 = 16;

/// Makes video, sound and `room.toml` of `seconds` in `directory`; gives the path of the room.
pub(crate) fn make(world: &World, directory: &Path) -> miette::Result<PathBuf> {
    std::fs::create_dir_all(directory)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot make {}", directory.display()))?;
    write_video(world, &directory.join("video.mp4"))?;
    write_sound(world, &directory.join("sound.wav"))?;
    let path = directory.join("room.toml");
    std::fs::write(&path, room_file())
        .into_diagnostic()
        .wrap_err_with(|| path.display().to_string())?;
    Ok(path)
}

fn room_file() -> String {
    let microphones: Vec<String> = MICROPHONES_M.iter().map(|place| format!("{place:?}")).collect();
    let (width, height) = (world::WIDTH, world::HEIGHT);
    let focal = world::FOCAL_PX;
    let (centre_u, centre_v) = (width as f64 / 2.0 - 0.5, height as f64 / 2.0 - 0.5);
    format!(
        "# Made by `hearsight demo`: two people who take turns in talking.\n\
         name = \"demo\"\n\n\
         [[camera]]\n\
         name = \"front\"\n\
         file = \"video.mp4\"\n\
         calibration = {{ model = \"pinhole\", width = {width}, height = {height}, focal_px = [{focal:?}, {focal:?}], \
         centre_px = [{centre_u:?}, {centre_v:?}], position_m = [0.0, 0.0, 1.4], look_at_m = [0.0, 3.0, 1.4] }}\n\n\
         [[array]]\n\
         name = \"pair\"\n\
         file = \"sound.wav\"\n\
         microphones = [{}]\n\n\
         [system]\n\
         name = \"stac\"\n",
        microphones.join(", ")
    )
}

fn write_sound(world: &World, path: &Path) -> miette::Result<()> {
    let failed = || path.display().to_string();
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: world::RATE_HZ,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(path, spec)
        .into_diagnostic()
        .wrap_err_with(failed)?;
    for pair in voices::render(world) {
        for sample in pair {
            let sample = (sample * f32::from(i16::MAX)).clamp(-32_767.0, 32_767.0) as i16;
            writer
                .write_sample(sample)
                .into_diagnostic()
                .wrap_err_with(failed)?;
        }
    }
    writer.finalize().into_diagnostic().wrap_err_with(failed)
}

fn write_video(world: &World, path: &Path) -> miette::Result<()> {
    let failed = || path.display().to_string();
    let interval = Span::from_seconds(1.0 / FRAMES_PER_SECOND);
    let options = VideoWriterOptions {
        interval,
        quality: QUALITY,
        ..VideoWriterOptions::default()
    };
    let mut writer = VideoWriter::create(path, world::WIDTH, world::HEIGHT, &options).into_diagnostic()?;
    let mut painter = painter::Painter::new(5);
    let mut rgb = Vec::new();
    for number in 0..(world.seconds * FRAMES_PER_SECOND) as i64 {
        let time = Instant::ZERO + interval * number;
        painter.paint(&world.people(time.seconds()), &mut rgb);
        let picture = RgbView {
            width: world::WIDTH,
            height: world::HEIGHT,
            data: &rgb,
        };
        writer
            .write(time, picture)
            .into_diagnostic()
            .wrap_err_with(failed)?;
    }
    writer.finish().into_diagnostic().wrap_err_with(failed)
}
