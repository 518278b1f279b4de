//! A second, independent reading of the messages that the program writes.

/// One message's fields, read from the front.
struct Cdr<'a> {
    data: &'a [u8],
    at: usize,
}

impl<'a> Cdr<'a> {
    fn new(data: &'a [u8]) -> Self {
        assert_eq!(data[..4], [0, 1, 0, 0], "plain CDR, little endian");
        Self { data: &data[4..], at: 0 }
    }

    fn take(&mut self, count: usize) -> &'a [u8] {
        self.at += count;
        &self.data[self.at - count..self.at]
    }

    fn u32(&mut self) -> u32 {
        self.at = self.at.next_multiple_of(4);
        u32::from_le_bytes(self.take(4).try_into().unwrap())
    }

    fn f64(&mut self) -> f64 {
        self.at = self.at.next_multiple_of(8);
        f64::from_le_bytes(self.take(8).try_into().unwrap())
    }

    fn text(&mut self) -> String {
        let length = self.u32() as usize;
        let (text, end) = self.take(length).split_at(length - 1);
        assert_eq!(end, [0]);
        String::from_utf8(text.to_vec()).unwrap()
    }

    fn list<T>(&mut self, item: impl Fn(&mut Self) -> T) -> Vec<T> {
        let length = self.u32();
        (0..length).map(|_| item(self)).collect()
    }

    /// Stamp in nanoseconds; the frame is passed over.
    fn header(&mut self) -> u64 {
        let (seconds, nanos) = (self.u32(), self.u32());
        self.text();
        u64::from(seconds) * 1_000_000_000 + u64::from(nanos)
    }

    fn end(&self) {
        assert_eq!(self.at, self.data.len(), "bytes behind the message");
    }
}

/// `sensor_msgs/msg/JointState`.
#[derive(Debug, Clone, PartialEq)]
pub struct JointState {
    pub stamp_nanos: u64,
    pub names: Vec<String>,
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub effort: Vec<f64>,
}

pub fn joint_state(data: &[u8]) -> JointState {
    let mut cdr = Cdr::new(data);
    let stamp_nanos = cdr.header();
    let names = cdr.list(Cdr::text);
    let [position, velocity, effort] = [(); 3].map(|()| cdr.list(Cdr::f64));
    cdr.end();
    JointState { stamp_nanos, names, position, velocity, effort }
}

/// `geometry_msgs/msg/WrenchStamped`: stamp, force and torque.
pub fn wrench(data: &[u8]) -> (u64, [f64; 6]) {
    stamped(data)
}

/// `geometry_msgs/msg/PoseStamped`: stamp, position and quaternion.
pub fn pose(data: &[u8]) -> (u64, [f64; 7]) {
    stamped(data)
}

fn stamped<const COUNT: usize>(data: &[u8]) -> (u64, [f64; COUNT]) {
    let mut cdr = Cdr::new(data);
    let stamp_nanos = cdr.header();
    let numbers = [(); COUNT].map(|()| cdr.f64());
    cdr.end();
    (stamp_nanos, numbers)
}

/// `fric_msgs/msg/CableStatus`: stamp, names and flags.
pub fn cable_status(data: &[u8]) -> (u64, Vec<String>, Vec<u32>) {
    let mut cdr = Cdr::new(data);
    let status = (cdr.header(), cdr.list(Cdr::text), cdr.list(Cdr::u32));
    cdr.end();
    status
}
