//! Where media come from, and what is plainly wrong with a place before libav is asked.

use crate::error::MediaError;
use std::fs;
use std::path::Path;

/// Whether `location` is a stream or device, which delivers at its own pace, rather than a file.
pub(crate) fn is_live(location: &str) -> bool {
    match scheme(location) {
        Some(scheme) => !matches!(
            scheme,
            "file" | "http" | "https" | "data" | "concat" | "crypto" | "cache"
        ),
        None => location.starts_with("/dev/") || is_session_description(location),
    }
}

/// Whether `location` is a file that describes an RTP session rather than holding media.
pub(crate) fn is_session_description(location: &str) -> bool {
    Path::new(location)
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("sdp"))
}

/// Whether `location` names something on this machine's file system.
pub(crate) fn is_path(location: &str) -> bool {
    scheme(location).is_none() && !location.starts_with("/dev/")
}

fn scheme(location: &str) -> Option<&str> {
    let (scheme, _) = location.split_once("://").or_else(|| {
        // `rtp:` and `udp:` may be written without slashes, but `C:` and `a:b.avi` are paths.
        location
            .split_once(':')
            .filter(|(scheme, _)| matches!(*scheme, "file" | "pipe" | "concat" | "data"))
    })?;
    scheme
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
        .then_some(scheme)
}

/// As [`check`], but with a named format the location may be anything, such as `hw:0` of `alsa`.
pub(crate) fn check_as(location: &str, format: Option<&str>) -> Result<(), MediaError> {
    match format {
        Some(_) if !Path::new(location).exists() && !location.contains('\0') => Ok(()),
        _ => check(location),
    }
}

/// Finds a missing, empty or unreadable file and a directory; streams and devices pass.
pub(crate) fn check(location: &str) -> Result<(), MediaError> {
    let named = || location.to_owned();
    if location.contains('\0') {
        return Err(MediaError::Missing {
            location: location.replace('\0', "\\0"),
        });
    }
    if !is_path(location) {
        if location.starts_with("/dev/") && !Path::new(location).exists() {
            return Err(MediaError::Missing { location: named() });
        }
        return Ok(());
    }
    let facts = fs::metadata(location).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => MediaError::Missing { location: named() },
        _ => MediaError::Unreadable {
            location: named(),
            reason: error.to_string(),
        },
    })?;
    if facts.is_dir() {
        return Err(MediaError::Directory { location: named() });
    }
    if facts.is_file() {
        if facts.len() == 0 {
            return Err(MediaError::Empty { location: named() });
        }
        fs::File::open(location).map_err(|error| MediaError::Unreadable {
            location: named(),
            reason: error.to_string(),
        })?;
    }
    Ok(())
}

/// The location as text; libav takes only UTF-8.
pub(crate) fn text(path: &Path) -> Result<String, MediaError> {
    path.to_str()
        .map(str::to_owned)
        .ok_or_else(|| MediaError::Unreadable {
            location: path.to_string_lossy().into_owned(),
            reason: "its name is not UTF-8".to_owned(),
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_devices_and_files_are_told_apart() {
        for live in [
            "rtsp://camera/1",
            "udp://127.0.0.1:5000",
            "/dev/video0",
            "tcp://0.0.0.0:1?listen",
        ] {
            assert!(is_live(live), "{live}");
            assert!(!is_path(live), "{live}");
        }
        for file in ["a.avi", "dir/a:b.avi", "C:\\a.avi", "/tmp/a.avi", "./rtsp:x"] {
            assert!(!is_live(file), "{file}");
            assert!(is_path(file), "{file}");
        }
        assert!(!is_live("https://example.org/a.mp4"));
    }
}
