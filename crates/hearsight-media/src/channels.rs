//! Which channels of a recording are delivered, and in which order.

use crate::error::MediaError;

/// Channels to deliver.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ChannelSelection {
    /// All, in the order of the file.
    #[default]
    All,
    /// All, in the order of the file; anything but this many is an error.
    Exactly(usize),
    /// These, counted from 0, in this order; one may occur twice.
    These(Vec<usize>),
}

impl ChannelSelection {
    /// The channels of a recording that has `present` of them.
    pub(crate) fn resolve(&self, location: &str, present: usize) -> Result<Vec<usize>, MediaError> {
        let location = || location.to_owned();
        match self {
            Self::Exactly(expected) if *expected != present => Err(MediaError::WrongChannels {
                location: location(),
                expected: *expected,
                found: present,
            }),
            Self::All | Self::Exactly(_) => Ok((0..present).collect()),
            Self::These(wanted) => {
                if wanted.is_empty() {
                    return Err(MediaError::BadOption {
                        location: location(),
                        option: "channels",
                        value: "an empty list".to_owned(),
                        cure: "name at least one channel, or leave the selection out for all",
                    });
                }
                match wanted.iter().find(|channel| **channel >= present) {
                    Some(channel) => Err(MediaError::NoSuchChannel {
                        location: location(),
                        channel: *channel,
                        last: present.saturating_sub(1),
                    }),
                    None => Ok(wanted.clone()),
                }
            }
        }
    }
}
