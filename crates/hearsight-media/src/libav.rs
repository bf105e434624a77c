//! What libav needs and its safe bindings lack: opening with a named format, options and a deadline at once.

mod log;

use ffmpeg_next::format::context::Input;
use ffmpeg_next::{Dictionary, Error, ffi};
use std::ffi::CString;
use std::ptr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Once};
use std::time;

/// Registers devices and passes libav's messages on, once.
pub(crate) fn initialize() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        log::begin();
        if let Err(error) = ffmpeg_next::init() {
            tracing::warn!(%error, "libav did not initialize");
        }
        ffmpeg_next::format::network::init();
    });
}

/// A deadline shared with libav's interrupt callback, which ends a blocking call once it has passed.
#[derive(Clone, Debug)]
pub(crate) struct Deadline {
    origin: time::Instant,
    /// Nanoseconds after `origin`; `u64::MAX` for none.
    at: Arc<AtomicU64>,
}

impl Deadline {
    pub(crate) fn new() -> Self {
        Self {
            origin: time::Instant::now(),
            at: Arc::new(AtomicU64::new(u64::MAX)),
        }
    }

    /// Blocking calls may last `timeout` from now.
    pub(crate) fn set(&self, timeout: time::Duration) {
        let at = (self.origin.elapsed() + timeout)
            .as_nanos()
            .min(u128::from(u64::MAX)) as u64;
        self.at.store(at, Ordering::Relaxed);
    }

    pub(crate) fn passed(&self) -> bool {
        let at = self.at.load(Ordering::Relaxed);
        at != u64::MAX && self.origin.elapsed().as_nanos() > u128::from(at)
    }
}

/// Opens `location` and finds its streams; a blocking call ends with [`Error::Exit`] when `deadline` passes. An empty
/// `format` leaves the format to be found out. Returned with the input is the time at which its first data arrived,
/// before libav listened to the stream for a while to know it.
#[expect(
    unsafe_code,
    reason = "the bindings open with a format or with an interrupt callback, never with both"
)]
pub(crate) fn open_input(
    location: &str,
    format: &str,
    options: Dictionary<'_>,
    deadline: &Deadline,
) -> Result<(Input, time::Instant), Error> {
    let location = CString::new(location).map_err(|_| Error::InvalidData)?;
    let format = CString::new(format).map_err(|_| Error::DemuxerNotFound)?;
    let watch = deadline.clone();
    let interrupt = ffmpeg_next::util::interrupt::new(Box::new(move || watch.passed()));
    // SAFETY: `context` is allocated here and either freed by libav on failure (avformat_open_input does so itself,
    // avformat_close_input after a failed probe) or owned by the returned `Input`, which also keeps the callback's
    // closure alive for as long as the context. The strings outlive the calls that read them. The dictionary is
    // taken over and freed by `Dictionary::own`.
    unsafe {
        let demuxer = if format.as_bytes().is_empty() {
            ptr::null()
        } else {
            let demuxer = ffi::av_find_input_format(format.as_ptr());
            if demuxer.is_null() {
                return Err(Error::DemuxerNotFound);
            }
            demuxer
        };
        let mut context = ffi::avformat_alloc_context();
        if context.is_null() {
            return Err(Error::Unknown);
        }
        (*context).interrupt_callback = interrupt.interrupt;
        let mut options = options.disown();
        let opened = ffi::avformat_open_input(&raw mut context, location.as_ptr(), demuxer, &raw mut options);
        drop(Dictionary::own(options));
        if opened < 0 {
            return Err(Error::from(opened));
        }
        let arrival = time::Instant::now();
        let found = ffi::avformat_find_stream_info(context, ptr::null_mut());
        if found < 0 {
            ffi::avformat_close_input(&raw mut context);
            return Err(Error::from(found));
        }
        Ok((Input::wrap_with_interrupt(context, interrupt.guard), arrival))
    }
}
