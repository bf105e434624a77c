//! Conversations, whose turns are drawn.

use super::names::Thing;
use super::people::{Draft, first_absence};
use super::raw::RawScene;
use super::resolve::Resolver;
use crate::acoustics::random::derive;
use crate::voice::draw_turns;
use hearsight_core::configuration::{ConfigurationError, Field};

impl Resolver {
    /// Draws the turns of conversations.
    pub(super) fn conversations(
        &self,
        raw: &RawScene,
        drafts: &mut [Draft],
    ) -> Result<(), ConfigurationError> {
        for (number, conversation) in raw.conversation.iter().enumerate() {
            let field = Field::of("conversation").index(number);
            let mut members = Vec::new();
            for (place, name) in conversation.people.iter().enumerate() {
                let at = field.key("people").index(place);
                let person = self.find(&at, name, "person", |thing| match thing {
                    Thing::Person(number, _) => Some(number),
                    _ => None,
                })?;
                if members.contains(&person) {
                    return Err(self.wrong(&at, format!("`{name}` takes part twice"), "name everybody once"));
                }
                members.push(person);
            }
            if conversation.people.is_empty() {
                members = (0..drafts.len()).collect();
            }
            if members.is_empty() {
                return Err(self.wrong(&field, "has nobody to take part", "add a [[person]]"));
            }
            let from = conversation.from.unwrap_or(0.5);
            let until = conversation.until.unwrap_or(self.seconds - 0.5);
            if !(from.is_finite() && until.is_finite() && from >= 0.0) {
                return Err(self.wrong(
                    &field,
                    "has no span of time",
                    "give `from` and `until` in seconds",
                ));
            }
            let mut settings = conversation.turns;
            if members.len() == 1 {
                settings.overlap = 0.0;
            }
            let seed = derive(self.seed, "conversation", number as u64);
            let turns = draw_turns(&settings, members.len(), from, until.max(from), seed)
                .map_err(|error| self.wrong(&field.key("turns"), error, "see `hearsight schema scenario`"))?;
            for turn in turns {
                let person = members[turn.person];
                let draft = &mut drafts[person];
                let [start, mut end] = [turn.start_s, turn.end_s];
                // Who is away says nothing, and who leaves stops talking.
                match first_absence(&draft.motion, start, end) {
                    Some(away) if away - start < 0.3 => continue,
                    Some(away) => end = away,
                    None => {}
                }
                if let Some(other) = draft
                    .turns
                    .iter()
                    .find(|other| other[0] < end && start < other[1])
                {
                    let name = self.name_of(&Field::of("person").index(person));
                    let what = format!(
                        "`{name}` already speaks from {:.2} to {:.2} s: the turn drawn at {start:.2} s overlaps it",
                        other[0], other[1]
                    );
                    let cure =
                        "write the turns of a person or draw them, or let the conversation have another time";
                    return Err(self.wrong(&field, what, cure));
                }
                draft.turns.push([start, end]);
            }
            for draft in &mut *drafts {
                draft.turns.sort_by(|one, other| one[0].total_cmp(&other[0]));
            }
        }
        Ok(())
    }
}
