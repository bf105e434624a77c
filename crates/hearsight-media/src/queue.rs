//! A bounded queue between a reader thread and its listener, which drops the oldest and reuses all memory.

use hearsight_core::Fault;
use hearsight_core::source::Delivery;
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Faults kept for a listener that does not ask; a source that fails for hours must not fill the memory.
const MOST_FAULTS: usize = 1000;

pub(crate) struct Queue<T> {
    state: Mutex<State<T>>,
    capacity: usize,
}

struct State<T> {
    items: VecDeque<T>,
    /// Buffers to be filled again.
    spare: Vec<T>,
    faults: Vec<Fault>,
    /// Items dropped in all, and since the listener last asked.
    dropped: u64,
    dropped_lately: u64,
    ended: bool,
    stopped: bool,
}

/// What a listener got.
pub(crate) struct Taken {
    pub(crate) delivery: Delivery,
    /// Items dropped since it last asked.
    pub(crate) dropped: u64,
}

impl<T: Default> Queue<T> {
    pub(crate) fn new(capacity: usize) -> Self {
        let capacity = capacity.max(1);
        let state = State {
            items: VecDeque::with_capacity(capacity + 1),
            spare: Vec::with_capacity(capacity + 1),
            faults: Vec::new(),
            dropped: 0,
            dropped_lately: 0,
            ended: false,
            stopped: false,
        };
        Self {
            state: Mutex::new(state),
            capacity,
        }
    }

    /// Appends `item`, dropping the oldest where the queue is full, and leaves a buffer in its place.
    pub(crate) fn put(&self, item: &mut T) {
        let mut state = self.lock();
        let buffer = if state.items.len() >= self.capacity {
            state.dropped += 1;
            state.dropped_lately += 1;
            state.items.pop_front()
        } else {
            state.spare.pop()
        };
        let item = std::mem::replace(item, buffer.unwrap_or_default());
        state.items.push_back(item);
    }

    /// Appends faults, emptying the list.
    pub(crate) fn report(&self, faults: &mut Vec<Fault>) {
        if !faults.is_empty() {
            let mut state = self.lock();
            let room = MOST_FAULTS.saturating_sub(state.faults.len());
            faults.truncate(room);
            state.faults.append(faults);
        }
    }

    /// Swaps the oldest item for the buffer `into`.
    pub(crate) fn take(&self, into: &mut T, faults: &mut Vec<Fault>) -> Taken {
        let mut state = self.lock();
        faults.append(&mut state.faults);
        let dropped = std::mem::take(&mut state.dropped_lately);
        let delivery = match state.items.pop_front() {
            Some(item) => {
                let buffer = std::mem::replace(into, item);
                state.spare.push(buffer);
                Delivery::Data
            }
            None if state.ended => Delivery::End,
            None => Delivery::Pending,
        };
        Taken { delivery, dropped }
    }

    pub(crate) fn dropped(&self) -> u64 {
        self.lock().dropped
    }

    /// Nothing more will be put.
    pub(crate) fn end(&self) {
        self.lock().ended = true;
    }

    /// Nobody listens any more.
    pub(crate) fn stop(&self) {
        self.lock().stopped = true;
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.lock().stopped
    }

    /// A thread that panicked while it held the lock cannot have left the lists half changed in a way that matters.
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_are_dropped_and_counted() {
        let queue = Queue::new(2);
        for mut item in 1..=5 {
            queue.put(&mut item);
        }
        let (mut item, mut faults) = (0, Vec::new());
        let taken = queue.take(&mut item, &mut faults);
        assert_eq!((taken.delivery, taken.dropped, item), (Delivery::Data, 3, 4));
        let taken = queue.take(&mut item, &mut faults);
        assert_eq!((taken.delivery, taken.dropped, item), (Delivery::Data, 0, 5));
        assert_eq!(queue.take(&mut item, &mut faults).delivery, Delivery::Pending);
        queue.end();
        assert_eq!(queue.take(&mut item, &mut faults).delivery, Delivery::End);
        assert_eq!(queue.dropped(), 3);
    }
}
