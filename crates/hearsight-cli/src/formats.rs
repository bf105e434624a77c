//! A pair of flags for each output, `--overlay` and `--no-overlay`, made from the registry of sinks.

use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches};
use hearsight::engine::sinks::registry;

/// Which outputs were switched on or off, as overrides of the configuration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Formats(Vec<(&'static str, bool)>);

impl Formats {
    /// The overrides, `("output.overlay", "true")`.
    pub(crate) fn overrides(&self) -> impl Iterator<Item = (String, String)> + '_ {
        self.0
            .iter()
            .map(|(name, on)| (format!("output.{name}"), on.to_string()))
    }
}

impl Args for Formats {
    fn augment_args(command: Command) -> Command {
        registry().iter().fold(command, |command, sink| {
            let (on, off) = (sink.name, format!("no-{}", sink.name));
            let switch = |name: String, other: String, help: String| {
                let kind = ArgAction::SetTrue;
                Arg::new(name.clone())
                    .long(name)
                    .action(kind)
                    .overrides_with(other)
                    .help(help)
                    .help_heading("Outputs")
            };
            // Only the one that changes something is worth a line of help.
            command
                .arg(
                    switch(
                        on.to_owned(),
                        off.clone(),
                        format!("Write {}. {}", sink.file, sink.summary),
                    )
                    .hide(sink.default),
                )
                .arg(
                    switch(
                        off,
                        on.to_owned(),
                        format!("Leave out {}. {}", sink.file, sink.summary),
                    )
                    .hide(!sink.default),
                )
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Formats {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut formats = Self::default();
        formats.update_from_arg_matches(matches)?;
        Ok(formats)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        self.0 = registry()
            .iter()
            .filter_map(|sink| {
                let given = |name: &str| matches.get_flag(name);
                match (given(sink.name), given(&format!("no-{}", sink.name))) {
                    (true, _) => Some((sink.name, true)),
                    (_, true) => Some((sink.name, false)),
                    _ => None,
                }
            })
            .collect();
        Ok(())
    }
}
