//! Text to raw configuration. Touches no file but the text.

use super::raw::RawRoom;
use hearsight_core::configuration::{ConfigurationError, Overrides, parse as parse_as};

/// Reads the text of a `room.toml`, with `overrides` laid over it. `name` is what errors call the file.
///
/// # Errors
/// [`ConfigurationError`] where the text is not TOML, a key is unknown, a value has the wrong type, or an override
/// names no field.
pub fn parse(name: &str, text: &str, overrides: &Overrides) -> Result<RawRoom, ConfigurationError> {
    parse_as(name, text, overrides)
}

/// The JSON schema of a `room.toml`, generated from the types. Parameters of systems have schemas of their own.
pub fn room_schema() -> serde_json::Value {
    schemars::schema_for!(RawRoom).to_value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overrides_reach_lists_by_number_and_by_name() {
        let text = "[[camera]]\nname = 'a'\nfile = 'a.avi'\n[[camera]]\nname = 'b'\nfile = 'b.avi'\n";
        let overrides = vec![
            ("camera.0.start".to_owned(), "1.5".to_owned()),
            ("camera.b.file".to_owned(), "other file.avi".to_owned()),
            ("run.seed".to_owned(), "7".to_owned()),
        ];
        let raw = parse("room.toml", text, &overrides).unwrap();
        assert_eq!(raw.camera[0].start, Some(1.5));
        assert_eq!(raw.camera[1].file.as_deref(), Some("other file.avi"));
        assert_eq!(raw.run.seed, Some(7));
    }

    #[test]
    fn an_unknown_key_has_a_suggestion_and_a_place() {
        let error = parse("room.toml", "[[camera]]\nname = 'a'\nfil = 'a.avi'\n", &vec![]).unwrap_err();
        assert_eq!(error.line_and_column(), Some((3, 1)));
        assert!(error.message.contains("unknown key `fil`"), "{error}");
        assert!(
            error.cure.as_deref().is_some_and(|cure| cure.contains("`file`")),
            "{:?}",
            error.cure
        );
    }

    #[test]
    fn a_wrong_override_is_blamed_on_itself() {
        let overrides = vec![("run.seeds".to_owned(), "7".to_owned())];
        let error = parse("room.toml", "", &overrides).unwrap_err();
        assert!(error.message.contains("run.seeds=7"), "{error}");
    }
}
