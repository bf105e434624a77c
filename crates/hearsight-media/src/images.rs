//! A camera from numbered pictures: a directory, a glob or a printf pattern, at a declared rate.

use crate::clock::SourceClock;
use crate::error::{MediaError, fault};
use crate::matrix::luma_from_rgb;
use hearsight_core::source::{Delivery, VideoFormat, VideoSource};
use hearsight_core::{Fault, FaultKind, Span, VideoFrame};
use image::ImageReader;
use std::fs;
use std::path::{Path, PathBuf};

/// How an image sequence is read.
#[derive(Clone, Debug)]
pub struct ImageOptions {
    /// The sensor's name, which faults carry; default is the pattern.
    pub name: String,
    /// When the first picture was taken; default 0 s, no drift.
    pub clock: SourceClock,
    /// Interval between pictures; default 40 ms.
    pub interval: Span,
}

impl Default for ImageOptions {
    fn default() -> Self {
        Self {
            name: String::new(),
            clock: SourceClock::default(),
            interval: Span::from_nanoseconds(40_000_000),
        }
    }
}

/// Reads pictures in order of their names or numbers.
///
/// With a printf pattern such as `frame_%06d.png` the number in the name is the frame's number, counted from the
/// first that is there, and one that is missing is a gap. Otherwise the pictures are numbered as they are sorted.
pub struct ImageSequence {
    /// Frame number from 0 and file of each picture.
    pictures: Vec<(u64, PathBuf)>,
    at: usize,
    last: Option<u64>,
    name: String,
    format: VideoFormat,
    clock: SourceClock,
}

impl ImageSequence {
    /// Opens the PNG and JPEG files of a directory, those that a glob (`*` and `?` in the file's name) matches, or
    /// those of a printf pattern.
    ///
    /// # Errors
    /// A place that is missing, holds no picture, or whose first picture cannot be read; an interval that is not
    /// positive.
    pub fn open(pattern: impl AsRef<Path>, options: ImageOptions) -> Result<Self, MediaError> {
        let pattern = pattern.as_ref();
        let location = pattern.to_string_lossy().into_owned();
        if options.interval <= Span::ZERO {
            return Err(MediaError::BadOption {
                location,
                option: "interval",
                value: format!("{} s", options.interval.seconds()),
                cure: "give the positive time between two pictures",
            });
        }
        let pictures = find(pattern, &location)?;
        let none = |reason: String| MediaError::NoPictures {
            location: location.clone(),
            reason,
        };
        let (first, frames) = match (pictures.first(), pictures.last()) {
            (Some(first), Some(last)) => (&first.1, last.0 + 1),
            _ => return Err(none("no file of that name".to_owned())),
        };
        let (width, height) = size_of(first).map_err(|reason| MediaError::NotMedia {
            location: first.to_string_lossy().into_owned(),
            reason,
        })?;
        let format = VideoFormat {
            width,
            height,
            interval: options.interval,
            frames: Some(frames),
            start: options.clock.start_on_arrival(std::time::Instant::now()),
            live: false,
        };
        let name = if options.name.is_empty() {
            location.clone()
        } else {
            options.name
        };
        Ok(Self {
            pictures,
            at: 0,
            last: None,
            name,
            format,
            clock: options.clock,
        })
    }

    fn load(&self, path: &Path, frame: &mut VideoFrame) -> Result<(), String> {
        let picture = ImageReader::open(path)
            .and_then(ImageReader::with_guessed_format)
            .map_err(|error| error.to_string())?
            .decode()
            .map_err(|error| error.to_string())?
            .into_rgb8();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        if (width, height) != (self.format.width, self.format.height) {
            return Err(format!("it has {width}x{height} pixels, unlike the first"));
        }
        (frame.width, frame.height) = (width, height);
        frame.rgb.clear();
        frame.rgb.extend_from_slice(picture.as_raw());
        frame.luma.resize(width * height, 0);
        luma_from_rgb(&frame.rgb, &mut frame.luma);
        Ok(())
    }
}

impl VideoSource for ImageSequence {
    fn format(&self) -> &VideoFormat {
        &self.format
    }

    fn read(&mut self, frame: &mut VideoFrame, faults: &mut Vec<Fault>) -> Delivery {
        while let Some((index, path)) = self.pictures.get(self.at) {
            self.at += 1;
            let time = self.format.start + self.clock.common_from_own(self.format.interval * *index as i64);
            let missing = self.last.map_or(0, |last| index - last - 1);
            self.last = Some(*index);
            if missing > 0 {
                let detail = format!("{missing} pictures are missing before {}", path.display());
                faults.push(fault(&self.name, time, FaultKind::Gap, detail));
            }
            match self.load(path, frame) {
                Ok(()) => {
                    (frame.time, frame.number) = (time, index + 1);
                    return Delivery::Data;
                }
                Err(reason) => {
                    let detail = format!("{} was left out: {reason}", path.display());
                    faults.push(fault(&self.name, time, FaultKind::Corrupt, detail));
                }
            }
        }
        Delivery::End
    }
}

fn size_of(path: &Path) -> Result<(usize, usize), String> {
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    let (width, height) = reader
        .map_err(|error| error.to_string())?
        .into_dimensions()
        .map_err(|error| error.to_string())?;
    if width == 0 || height == 0 {
        return Err("it has no pixels".to_owned());
    }
    Ok((width as usize, height as usize))
}

/// The files of a directory, glob or printf pattern with their frame numbers from 0.
fn find(pattern: &Path, location: &str) -> Result<Vec<(u64, PathBuf)>, MediaError> {
    let (folder, matcher) = if pattern.is_dir() {
        (pattern, Matcher::Pictures)
    } else {
        let name = pattern
            .file_name()
            .and_then(|name| name.to_str())
            .unwrap_or_default();
        let folder = pattern.parent().filter(|folder| !folder.as_os_str().is_empty());
        (folder.unwrap_or(Path::new(".")), Matcher::new(name))
    };
    let entries = fs::read_dir(folder).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => MediaError::Missing {
            location: folder.to_string_lossy().into_owned(),
        },
        _ => MediaError::Unreadable {
            location: location.to_owned(),
            reason: error.to_string(),
        },
    })?;
    let mut found: Vec<(u64, String)> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter_map(|name| Some((matcher.number(&name)?, name)))
        .collect();
    found.sort();
    let numbered = matches!(matcher, Matcher::Numbered { .. });
    // `frame_1.png` and `frame_01.png` are the same frame of `frame_%d.png`; the first by name is taken.
    found.dedup_by_key(|(number, name)| {
        if numbered {
            (*number, String::new())
        } else {
            (0, name.clone())
        }
    });
    let first = found.first().map_or(0, |(number, _)| *number);
    let place = |(at, (number, name)): (usize, (u64, String))| {
        (
            if numbered { number - first } else { at as u64 },
            folder.join(name),
        )
    };
    Ok(found.into_iter().enumerate().map(place).collect())
}

/// Which names of a directory belong to the sequence.
enum Matcher {
    /// Every PNG or JPEG.
    Pictures,
    /// `*` for anything, `?` for any character.
    Glob(Vec<char>),
    /// A number between two texts, at least `digits` wide.
    Numbered {
        before: String,
        after: String,
        digits: usize,
    },
}

impl Matcher {
    fn new(pattern: &str) -> Self {
        if let Some((before, rest)) = pattern.split_once('%')
            && let Some((digits, after)) = rest.split_once('d')
            && digits.chars().all(|digit| digit.is_ascii_digit())
        {
            let digits = digits.parse().unwrap_or(1);
            return Self::Numbered {
                before: before.to_owned(),
                after: after.to_owned(),
                digits,
            };
        }
        Self::Glob(pattern.chars().collect())
    }

    /// The number in a name that matches; 0 where the pattern has none.
    fn number(&self, name: &str) -> Option<u64> {
        match self {
            Self::Pictures => {
                let extension = Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
                matches!(extension.as_str(), "png" | "jpg" | "jpeg").then_some(0)
            }
            Self::Glob(pattern) => matches_glob(pattern, name).then_some(0),
            Self::Numbered {
                before,
                after,
                digits,
            } => {
                let number = name.strip_prefix(before.as_str())?.strip_suffix(after.as_str())?;
                let plain = number.chars().all(|digit| digit.is_ascii_digit()) && number.len() >= *digits;
                if plain { number.parse().ok() } else { None }
            }
        }
    }
}

/// Whether `name` matches a glob; the last star is taken up again where a guess fails, so no pattern is slow.
fn matches_glob(pattern: &[char], name: &str) -> bool {
    let name: Vec<char> = name.chars().collect();
    let (mut at, mut place) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while place < name.len() {
        match pattern.get(at) {
            Some('*') => {
                star = Some((at, place));
                at += 1;
            }
            Some(character) if *character == '?' || *character == name[place] => {
                at += 1;
                place += 1;
            }
            _ => match star {
                Some((back, from)) => {
                    star = Some((back, from + 1));
                    (at, place) = (back + 1, from + 1);
                }
                None => return false,
            },
        }
    }
    pattern[at..].iter().all(|character| *character == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_matched() {
        let numbered = Matcher::new("frame_%03d.png");
        assert_eq!(numbered.number("frame_012.png"), Some(12));
        assert_eq!(numbered.number("frame_1012.png"), Some(1012));
        for other in [
            "frame_12.png",
            "frame_0x2.png",
            "frame_.png",
            "a_012.png",
            "frame_012.jpg",
        ] {
            assert_eq!(numbered.number(other), None, "{other}");
        }
        let glob: Vec<char> = "a*b?.png".chars().collect();
        assert!(matches_glob(&glob, "axxbybz.png"));
        assert!(!matches_glob(&glob, "axxb.png"));
    }
}
