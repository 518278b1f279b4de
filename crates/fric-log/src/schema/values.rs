//! The numbers, texts and times read from one message.
//!
//! The buffers are reused from message to message, so that reading stops allocating after the first few. Numbers are passed on unchanged, including
//! NaN and infinities.

/// The content of a message, by the index of the field in the list of wanted fields.
///
/// A path that selects nothing in this message, such as `[3]` of an array of two or a filter that nothing passes, gives an empty list.
#[derive(Debug, Clone, Default)]
pub struct Values {
    /// Slots of the wanted fields, followed by those for testing filters.
    slots: Vec<Slot>,
    wanted: usize,
}

/// A list of texts and the count of its changes.
#[derive(Debug, Clone, Default)]
pub struct Texts {
    current: TextList,
    next: TextList,
    /// The encoded form of `current`, or empty if it is not known.
    raw: Vec<u8>,
    /// Whether this message has the same texts, so that `next` is unused.
    kept: bool,
    revision: u64,
}

#[derive(Debug, Clone, Default)]
struct TextList {
    text: String,
    ends: Vec<usize>,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Slot {
    pub numbers: Vec<f64>,
    pub times_nanos: Vec<i64>,
    pub texts: Texts,
}

impl Values {
    /// Returns the numbers of the wanted field with this index; empty for an unknown index.
    ///
    /// 64-bit integers beyond ±2⁵³ are rounded to the nearest `f64`.
    #[must_use]
    pub fn numbers(&self, index: usize) -> &[f64] {
        self.slot(index).map_or(&[], |slot| &slot.numbers)
    }

    /// Returns the number of a field that has exactly one.
    #[must_use]
    pub fn number(&self, index: usize) -> Option<f64> {
        match self.numbers(index) {
            [number] => Some(*number),
            _ => None,
        }
    }

    /// Returns the exact times of the wanted field with this index, in nanoseconds; empty for an unknown index.
    #[must_use]
    pub fn times_nanos(&self, index: usize) -> &[i64] {
        self.slot(index).map_or(&[], |slot| &slot.times_nanos)
    }

    /// Returns the time of a field that has exactly one, in nanoseconds.
    #[must_use]
    pub fn time_nanos(&self, index: usize) -> Option<i64> {
        match self.times_nanos(index) {
            [time_nanos] => Some(*time_nanos),
            _ => None,
        }
    }

    /// Returns the texts of the wanted field with this index; empty for an unknown index.
    #[must_use]
    pub fn texts(&self, index: usize) -> &Texts {
        static NONE: Texts = Texts {
            current: TextList { text: String::new(), ends: Vec::new() },
            next: TextList { text: String::new(), ends: Vec::new() },
            raw: Vec::new(),
            kept: false,
            revision: 0,
        };
        self.slot(index).map_or(&NONE, |slot| &slot.texts)
    }

    fn slot(&self, index: usize) -> Option<&Slot> {
        self.slots.get(..self.wanted)?.get(index)
    }

    /// Creates space for the wanted fields, and for `slots` slots in all.
    pub(super) fn new(wanted: usize, slots: usize) -> Self {
        Self { slots: vec![Slot::default(); slots.max(wanted)], wanted }
    }

    /// Prepares for the next message.
    pub(super) fn begin(&mut self) -> &mut [Slot] {
        for slot in &mut self.slots {
            slot.numbers.clear();
            slot.times_nanos.clear();
            slot.texts.next.clear();
            slot.texts.kept = false;
        }
        &mut self.slots
    }

    /// Takes over the texts of a completely read message.
    pub(super) fn finish(&mut self) {
        for texts in self.slots.iter_mut().map(|slot| &mut slot.texts) {
            if !texts.kept && !texts.next.is_same(&texts.current) {
                std::mem::swap(&mut texts.next, &mut texts.current);
                texts.revision += 1;
            }
        }
    }

    /// Discards the encoded texts, so that the next message is not compared with them.
    pub(super) fn forget_raw_texts(&mut self) {
        for slot in &mut self.slots {
            slot.texts.raw.clear();
        }
    }
}

impl Texts {
    /// Returns the texts in order.
    #[must_use]
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &str> {
        (0..self.len()).map(|index| self.get(index).unwrap_or_default())
    }

    /// Returns the text at an index.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<&str> {
        self.current.get(index)
    }

    /// Returns the number of texts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.current.ends.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.current.ends.is_empty()
    }

    /// Returns a number that grows whenever a message contains other texts than the one before.
    ///
    /// While it is unchanged, everything derived from the texts, such as the order of the cables of a `JointState`, stays valid. It starts at 0 with
    /// no texts.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    pub(super) fn push(&mut self, text: &str) {
        self.next.text.push_str(text);
        self.next.ends.push(self.next.text.len());
    }

    /// Returns the length of the encoded texts of the last message, if `bytes` starts with the same.
    pub(super) fn keep_if_same(&mut self, bytes: &[u8]) -> Option<usize> {
        let same = !self.raw.is_empty() && bytes.starts_with(&self.raw);
        self.kept = same;
        same.then_some(self.raw.len())
    }

    pub(super) fn remember_raw(&mut self, bytes: &[u8]) {
        self.raw.clear();
        self.raw.extend_from_slice(bytes);
    }

    /// Returns the text read last from this message.
    pub(super) fn last_read(&self) -> Option<&str> {
        self.next.get(self.next.ends.len().checked_sub(1)?)
    }

    pub(super) fn forget_read(&mut self) {
        self.next.clear();
    }
}

impl TextList {
    fn get(&self, index: usize) -> Option<&str> {
        let end = *self.ends.get(index)?;
        let start = match index.checked_sub(1) {
            Some(before) => *self.ends.get(before)?,
            None => 0,
        };
        self.text.get(start..end)
    }

    /// Whether both contain the same texts.
    ///
    /// Most slots have no texts; comparing their empty buffers, which point nowhere, would cost some processors more than reading a whole message.
    fn is_same(&self, other: &Self) -> bool {
        match (self.ends.is_empty(), other.ends.is_empty()) {
            (true, true) => true,
            (false, false) => self.ends == other.ends && (self.text.is_empty() || self.text == other.text),
            _ => false,
        }
    }

    fn clear(&mut self) {
        self.text.clear();
        self.ends.clear();
    }
}
