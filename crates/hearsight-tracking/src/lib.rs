//! What tracking systems are made of, in the order of the data's way.
//!
//! [`percepts`] are computed once from a moment; a [`body`] maps hypotheses to regions and sound points; [`cues`] score
//! them; [`fusion`] turns scores into weights; a [`closed_loop`] of trackers and a fuser proposes; [`stage`]s run a filter on a [`belief`]; the [`life_cycle`] decides who is
//! born, hidden, gone and back; the [`speaker`] is decided over all tracks. A [`tracker`] does it for one view.
//!
//! Beside those of people there are beliefs of a [`sound`], which may belong to nobody, and of [`face`]s in one picture;
//! [`sight_and_sound`] puts both together in the room.
//!
//! Nothing here opens a file or knows a system's name.

pub mod belief;
pub mod body;
pub mod closed_loop;
pub mod cues;
pub mod face;
pub mod fusion;
pub mod life_cycle;
pub mod momentum;
pub mod percepts;
pub mod proposals;
pub mod sight_and_sound;
pub mod sound;
pub mod sound_map;
pub mod speaker;
pub mod stage;
pub mod system;
pub mod tracker;
