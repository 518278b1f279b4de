//! Merges the messages of overlapping segments into one order: by log time, and at equal times as in the files.
//!
//! A message is delivered only when no segment that is still to be loaded can contain an earlier one. Usually segments do not overlap, which costs
//! one comparison per message. Overlapping segments are open together, up to [`OPEN_BYTES`] of content; beyond that, messages are delivered without
//! waiting and may then be late.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use super::load::{Loaded, MessagePlace};
use super::record::{MESSAGE_FIELDS_LEN, MessageFields, framed_at, op};
use super::segment::Segment;

/// Maximum number of bytes of overlapping open segments. One segment may be larger if it is alone.
pub(super) const OPEN_BYTES: u64 = 40 * 1024 * 1024;

/// The order of messages: log time, then rank of the segment.
type Key = (u64, u32);

/// The next message of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Head {
    pub(super) fields: MessageFields,
    data_at: usize,
    end: usize,
}

/// A loaded segment with a reading position.
pub(super) struct OpenSegment {
    loaded: Loaded,
    pub(super) file: u32,
    rank: u32,
    memory_len: u64,
    /// Ids of channels whose messages must not be delivered.
    pub(super) rejected: Vec<u16>,
    head: Option<Head>,
    /// The next position: in the content, or in the list of positions if there is one.
    next: usize,
}

impl OpenSegment {
    pub(super) fn new(loaded: Loaded, segment: &Segment, rejected: Vec<u16>) -> Self {
        let mut open = Self {
            file: segment.file,
            rank: segment.rank,
            memory_len: loaded.memory_len(),
            loaded,
            rejected,
            head: None,
            next: 0,
        };
        open.advance();
        open
    }

    pub(super) fn into_buffer(self) -> Vec<u8> {
        self.loaded.content
    }

    fn key(&self) -> Option<Key> {
        self.head.map(|head| (head.fields.log_time_nanos, self.rank))
    }

    /// Advances to the next message.
    #[inline]
    fn advance(&mut self) {
        self.head = match &self.loaded.order {
            None => self.next_in_place(),
            Some(order) => {
                let place = order.get(self.next).copied();
                self.next += 1;
                place.and_then(|place| head_at(&self.loaded.content, place))
            }
        };
    }

    #[inline]
    fn next_in_place(&mut self) -> Option<Head> {
        loop {
            let record = framed_at(&self.loaded.content, self.next)?;
            let start = record.next - record.body.len();
            self.next = record.next;
            if record.opcode == op::MESSAGE {
                return Some(Head {
                    fields: MessageFields::parse(record.body)?,
                    data_at: start + MESSAGE_FIELDS_LEN,
                    end: record.next,
                });
            }
        }
    }
}

fn head_at(content: &[u8], (_, place): MessagePlace) -> Option<Head> {
    let record = framed_at(content, place as usize)?;
    Some(Head {
        fields: MessageFields::parse(record.body)?,
        data_at: record.next - record.body.len() + MESSAGE_FIELDS_LEN,
        end: record.next,
    })
}

/// The next action.
pub(super) enum Step {
    /// The head of the current segment is the next message.
    Deliver(Head),
    /// The next segment must be loaded and added.
    Load,
    /// A segment has no more messages.
    Retire(OpenSegment),
    /// There are no more messages.
    End,
}

/// The open segments and their order.
pub(super) struct Merge {
    segments: Arc<[Segment]>,
    /// The next segment to be loaded.
    next_segment: usize,
    open: Vec<Option<OpenSegment>>,
    free: Vec<usize>,
    /// Open segments except the current one.
    heap: BinaryHeap<Reverse<(u64, u32, usize)>>,
    open_bytes: u64,
    current: Option<OpenSegment>,
    /// The current segment continues as long as its messages come before this key.
    limit: Option<Key>,
    /// Whether the head of the current segment was delivered.
    is_head_used: bool,
}

impl Merge {
    pub(super) fn new(segments: Arc<[Segment]>) -> Self {
        Self {
            segments,
            next_segment: 0,
            open: Vec::new(),
            free: Vec::new(),
            heap: BinaryHeap::new(),
            open_bytes: 0,
            current: None,
            limit: None,
            is_head_used: false,
        }
    }

    /// Determines the next action. After [`Step::Deliver`] the message counts as delivered.
    #[inline]
    pub(super) fn step(&mut self) -> Step {
        if let Some(current) = &mut self.current {
            if self.is_head_used {
                current.advance();
            }
            if let Some(head) = current.head
                && self.limit.is_none_or(|limit| (head.fields.log_time_nanos, current.rank) < limit)
            {
                self.is_head_used = true;
                return Step::Deliver(head);
            }
            self.is_head_used = false;
        }
        self.choose()
    }

    /// Changes the current segment.
    fn choose(&mut self) -> Step {
        if let Some(current) = self.current.take() {
            let Some(key) = current.key() else {
                self.open_bytes = self.open_bytes.saturating_sub(current.memory_len);
                return Step::Retire(current);
            };
            self.shelve(current, key);
        }
        let pending = self.segments.get(self.next_segment);
        let first = self.heap.peek().map(|Reverse((time, rank, _))| (*time, *rank));
        let fits = pending.is_some_and(|pending| self.open_bytes.saturating_add(pending.memory_len()) <= OPEN_BYTES);
        match (first, pending) {
            (None, None) => return Step::End,
            (None, Some(_)) => return Step::Load,
            (Some(first), Some(pending)) if fits && pending.load_key() < first => {
                return Step::Load;
            }
            _ => {}
        }
        if let Some(Reverse((_, _, slot))) = self.heap.pop() {
            self.current = self.open.get_mut(slot).and_then(Option::take);
            self.free.push(slot);
        }
        let second = self.heap.peek().map(|Reverse((time, rank, _))| (*time, *rank));
        let pending_key = pending.filter(|_| fits).map(Segment::load_key);
        self.limit = match (second, pending_key) {
            (Some(second), Some(pending)) => Some(second.min(pending)),
            (second, pending) => second.or(pending),
        };
        self.step()
    }

    fn shelve(&mut self, open: OpenSegment, (time, rank): Key) {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.open.push(None);
            self.open.len() - 1
        });
        if let Some(place) = self.open.get_mut(slot) {
            *place = Some(open);
        }
        self.heap.push(Reverse((time, rank, slot)));
    }

    /// Returns the segment that [`Step::Load`] asks for, which counts as loaded from now on.
    pub(super) fn start_next(&mut self) -> Option<(usize, Segment)> {
        let place = self.next_segment;
        let segment = self.segments.get(place)?.clone();
        self.next_segment += 1;
        Some((place, segment))
    }

    /// Adds a loaded segment; returns it if it has no messages.
    pub(super) fn add(&mut self, open: OpenSegment) -> Option<OpenSegment> {
        let Some(key) = open.key() else {
            return Some(open);
        };
        self.open_bytes = self.open_bytes.saturating_add(open.memory_len);
        self.shelve(open, key);
        None
    }

    /// Returns the file of the current segment, and whether it must not deliver the channel's messages.
    #[inline]
    pub(super) fn current_file(&self, channel_id: u16) -> Option<(u32, bool)> {
        let current = self.current.as_ref()?;
        let is_rejected = !current.rejected.is_empty() && current.rejected.contains(&channel_id);
        Some((current.file, is_rejected))
    }

    /// Returns the index of the current segment in the loading order.
    pub(super) fn current_segment(&self) -> Option<usize> {
        self.current.as_ref().map(|current| current.loaded.segment)
    }

    /// Returns the payload of a message of the current segment.
    #[inline]
    pub(super) fn payload(&self, head: &Head) -> &[u8] {
        self.current.as_ref().and_then(|current| current.loaded.content.get(head.data_at..head.end)).unwrap_or_default()
    }
}
