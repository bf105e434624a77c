//! What libav says, passed on to `tracing` with the target `libav`.
//!
//! Its errors and warnings are ours to debug with, no more: they carry neither the sensor nor the consequence, and what
//! matters comes back as errors and faults. `RUST_LOG=libav=debug` shows them, `libav=trace` also what it tells besides.

#[cfg(target_arch = "x86_64")]
pub(super) use forwarding::begin;

/// Elsewhere the bindings have another type for the arguments of a message, and libav is silent.
#[cfg(not(target_arch = "x86_64"))]
pub(super) fn begin() {
    ffmpeg_next::log::set_level(ffmpeg_next::log::Level::Quiet);
}

#[cfg(target_arch = "x86_64")]
mod forwarding {
    use ffmpeg_next::ffi;
    use std::ffi::{CStr, c_char, c_int, c_void};

    /// Longest message, bytes; longer ones are cut.
    const LONGEST: usize = 1024;

    /// From now on libav's messages are passed on.
    #[expect(
        unsafe_code,
        reason = "the bindings have no safe way to listen to libav's messages"
    )]
    pub(in super::super) fn begin() {
        // SAFETY: the callback lasts as long as the program, takes what libav gives by its own type, and keeps nothing.
        unsafe { ffi::av_log_set_callback(Some(forward)) };
    }

    /// Called by libav on any of its threads.
    #[expect(unsafe_code, reason = "libav calls it, and formats the message")]
    unsafe extern "C" fn forward(
        class: *mut c_void,
        level: c_int,
        format: *const c_char,
        arguments: *mut ffi::__va_list_tag,
    ) {
        // The upper bits are a colour.
        let level = level & 0xff;
        let is_warning = level <= ffi::AV_LOG_WARNING;
        let is_wanted = if is_warning {
            tracing::enabled!(target: "libav", tracing::Level::DEBUG)
        } else {
            level <= ffi::AV_LOG_VERBOSE && tracing::enabled!(target: "libav", tracing::Level::TRACE)
        };
        if !is_wanted {
            return;
        }
        let (mut line, mut prefix): ([c_char; LONGEST], c_int) = ([0; LONGEST], 1);
        // SAFETY: class, format and arguments are libav's own, for this call; the line is as long as is said, and what
        // is written there ends with zero.
        let text = unsafe {
            let size = LONGEST as c_int;
            ffi::av_log_format_line2(
                class,
                level,
                format,
                arguments,
                line.as_mut_ptr(),
                size,
                &raw mut prefix,
            );
            CStr::from_ptr(line.as_ptr())
        };
        let text = text.to_string_lossy();
        match text.trim_end() {
            "" => {}
            text if is_warning => tracing::debug!(target: "libav", "libav: {text}"),
            text => tracing::trace!(target: "libav", "libav: {text}"),
        }
    }
}
