//! Who is here, where are they, who is speaking: from raw cameras and microphones.
//!
//! This is the crate to depend on. [`load`] reads a `room.toml`, [`Engine::open`] opens its sensors,
//! [`Engine::step`] gives a [`Scene`] a tick:
//!
//! ```no_run
//! let room = hearsight::load("room.toml".as_ref())?;
//! let mut engine = hearsight::Engine::open(room)?;
//! while let Some(scene) = engine.step() {
//!     println!("{:.2} s: {} people, speaker {:?}", scene.time_s, scene.tracks.len(), scene.speaker);
//! }
//! # Ok::<(), hearsight::EngineError>(())
//! ```
//!
//! It holds nothing of its own: every part is a crate, found here under its short name.

pub use hearsight_audio as audio;
pub use hearsight_calibrate as calibrate;
pub use hearsight_core as core;
pub use hearsight_engine as engine;
pub use hearsight_eval as eval;
pub use hearsight_filter as filter;
pub use hearsight_media as media;
pub use hearsight_sim as sim;
pub use hearsight_systems as systems;
pub use hearsight_tracking as tracking;
pub use hearsight_vision as vision;

pub use hearsight_core::record::{Scene, SoundRecord, TrackRecord};
pub use hearsight_core::{Instant, Moment, Span};
pub use hearsight_engine::config::{ConfigurationError, ResolvedRoom, load_room as load};
pub use hearsight_engine::{Engine, EngineError, Outputs, Summary, run};
