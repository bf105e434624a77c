//! The sound field of a box: what microphones hear of sources that move and turn in it.
//!
//! * [`Shoebox`] — the room: size, walls, reverberation time, for which the absorption is sought.
//! * [`SoundSource`] — a [`Path`] (where it is and faces), a [`Sound`] (its samples), directivity and level.
//! * [`Microphone`], [`Mismatch`], [`DeviceClock`], [`Placement`] — the array that listens, where, and its clock.
//! * [`ArrayRenderer`] — takes room, sources and microphones and gives their samples, block after block.
//! * [`Responder`] — impulse responses between points that stay; [`MeasuredResponse`] — real ones instead.
//!
//! All positions are of the world, metres; all times seconds of the scenario. Sources are pure functions of time, which
//! may be asked ahead; placements are asked in the order of time and not ahead, since devices obey commands.
//!
//! ```
//! use hearsight_core::{AudioBlock, WorldPoint};
//! use hearsight_sim::acoustics::{
//!     ArrayRenderer, Clip, Directivity, Emission, Microphone, RenderSettings, Shoebox, ShoeboxSettings, SoundSource,
//!     Walls,
//! };
//! use std::sync::Arc;
//!
//! let room = Shoebox::new(&ShoeboxSettings::new([5.0, 4.0, 2.7], Walls::T60(0.4)))?;
//! let walk = |time_s: f64| {
//!     let position = WorldPoint::new(1.0 + time_s.clamp(0.0, 3.0), 2.0, 1.6);
//!     Some(Emission { position, facing: nalgebra::Vector3::x() })
//! };
//! let click = Clip { rate_hz: 16_000, first: 800, samples: vec![1.0] };
//! let source = SoundSource {
//!     name: "click".to_owned(),
//!     path: Arc::new(walk),
//!     sound: Arc::new(click),
//!     directivity: Directivity::MOUTH,
//!     level_db: -20.0,
//! };
//! let microphones = vec![Microphone::default(); 2];
//! let mut renderer = ArrayRenderer::new(&room, vec![source], microphones, &RenderSettings::new(16_000))?;
//! let pair = vec![WorldPoint::new(4.0, 1.9, 1.2), WorldPoint::new(4.0, 2.1, 1.2)];
//! let mut block = AudioBlock::default();
//! renderer.render(&pair, 1600, &mut block)?;
//! assert_eq!((block.channels.len(), block.channels[0].len()), (2, 1600));
//! # Ok::<(), hearsight_sim::acoustics::AcousticsError>(())
//! ```

mod bands;
mod decay;
mod diffuse;
mod early;
mod emitter;
pub(crate) mod error;
mod high_pass;
mod kernel;
mod lattice;
mod measured;
mod microphones;
pub(crate) mod random;
mod renderer;
mod response;
mod room;
mod settings;
pub(crate) mod source;
mod synthesis;
mod tail;

pub use decay::reverberation_time_s;
pub use diffuse::DiffuseNoise;
pub use error::AcousticsError;
pub use measured::MeasuredResponse;
pub use microphones::{DeviceClock, Microphone, Mismatch, Placement};
pub use renderer::ArrayRenderer;
pub use response::{ImpulseResponse, Responder, ResponseSettings};
pub use room::{BAND_CENTRES_HZ, BANDS, Shoebox, ShoeboxSettings, Walls};
pub use settings::RenderSettings;
pub use source::{Clip, Directivity, Emission, Path, Sound, SoundSource, Standing};
