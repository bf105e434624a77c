//! What the command line lays over a `room.toml`.

use clap::Args;
use hearsight::engine::config::Overrides;

/// Options that every command on a room takes.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct RoomOverrides {
    /// Set any key of the file, such as `system.stac.particles=400` or `camera.cam1.start=11.08`.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
    /// Begin at this time on the common clock, seconds.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    from: Option<f64>,
    /// End at this time on the common clock, seconds.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Seed of every random number.
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// Threads for tracking; 0 takes one a processor. Results do not depend on it.
    #[arg(long, value_name = "NUMBER")]
    threads: Option<usize>,
    /// The system that tracks.
    #[arg(long, value_name = "NAME")]
    system: Option<String>,
}

impl RoomOverrides {
    /// The overrides, those of `--set` first.
    pub(crate) fn list(&self) -> Overrides {
        let mut list = self.set.clone();
        let mut add =
            |key: &str, value: Option<String>| list.extend(value.map(|value| (key.to_owned(), value)));
        add("run.from", self.from.map(|value| format!("{value:?}")));
        add("run.until", self.until.map(|value| format!("{value:?}")));
        add("run.seed", self.seed.map(|value| value.to_string()));
        add("run.threads", self.threads.map(|value| value.to_string()));
        add(
            "system.name",
            self.system.as_ref().map(|value| format!("{value:?}")),
        );
        list
    }
}

fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err("write KEY=VALUE, such as run.seed=7".to_owned()),
    }
}
