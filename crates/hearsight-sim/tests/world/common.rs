//! Scenarios that are written in tests.

use hearsight_core::configuration::Overrides;
use hearsight_sim::scenario::from_text;
use hearsight_sim::world::World;

/// The world of a scenario that must be sound.
pub(crate) fn world(text: &str) -> World {
    from_text("scene.toml", text, &Overrides::new()).unwrap_or_else(|error| panic!("{error}"))
}

/// Message and cure of a scenario that must be refused.
pub(crate) fn refusal(text: &str) -> String {
    match from_text("scene.toml", text, &Overrides::new()) {
        Ok(_) => panic!("this was taken: {text}"),
        Err(error) => format!("{error} | {}", error.cure.as_deref().unwrap_or("")),
    }
}
