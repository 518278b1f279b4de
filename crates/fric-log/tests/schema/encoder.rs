//! CDR written from the standard's rules, for comparison with what is read.

/// Writes the primitives of plain CDR or CDR2 in either byte order.
pub(crate) struct Encoder {
    bytes: Vec<u8>,
    big_endian: bool,
    cdr2: bool,
}

impl Encoder {
    pub(crate) fn new(big_endian: bool, cdr2: bool) -> Self {
        let id = match (cdr2, big_endian) {
            (false, true) => 0,
            (false, false) => 1,
            (true, true) => 6,
            (true, false) => 7,
        };
        Self { bytes: vec![0, id, 0, 0], big_endian, cdr2 }
    }

    pub(crate) fn done(self) -> Vec<u8> {
        self.bytes
    }

    pub(crate) fn is_cdr2(&self) -> bool {
        self.cdr2
    }

    /// A number of which the little-endian bytes are given.
    pub(crate) fn scalar(&mut self, little_endian: &[u8]) {
        let align = if self.cdr2 { little_endian.len().min(4) } else { little_endian.len() };
        while !(self.bytes.len() - 4).is_multiple_of(align) {
            self.bytes.push(0xaa);
        }
        if self.big_endian {
            self.bytes.extend(little_endian.iter().rev());
        } else {
            self.bytes.extend(little_endian);
        }
    }

    pub(crate) fn u32(&mut self, value: u32) -> &mut Self {
        self.scalar(&value.to_le_bytes());
        self
    }

    pub(crate) fn count(&mut self, count: usize) -> &mut Self {
        self.u32(u32::try_from(count).unwrap())
    }

    pub(crate) fn f64(&mut self, value: f64) -> &mut Self {
        self.scalar(&value.to_le_bytes());
        self
    }

    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        self.count(text.len() + 1);
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
        self
    }

    pub(crate) fn texts(&mut self, texts: &[&str]) -> &mut Self {
        if self.cdr2 {
            self.u32(0xdead);
        }
        self.count(texts.len());
        for text in texts {
            self.text(text);
        }
        self
    }

    pub(crate) fn f64s(&mut self, values: &[f64]) -> &mut Self {
        self.count(values.len());
        for value in values {
            self.f64(*value);
        }
        self
    }
}

/// A `sensor_msgs/JointState` of these contents.
pub(crate) fn joint_state(encoder: &mut Encoder, stamp: (u32, u32), names: &[&str], arrays: [&[f64]; 3]) {
    encoder.u32(stamp.0).u32(stamp.1).text("base").texts(names);
    for array in arrays {
        encoder.f64s(array);
    }
}
