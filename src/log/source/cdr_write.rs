//! Messages as they are written to MCAP: JointState in little-endian CDR.

/// A message without its numbers: all messages of the same joints differ in these only.
#[derive(Clone, Debug)]
pub(in crate::log) struct JointStateForm {
    bytes: Vec<u8>,
    /// Where positions, velocities and efforts begin.
    fields: [usize; 3],
}

impl JointStateForm {
    /// Of joints with these names, and so many positions, velocities and efforts.
    pub fn new(names: &[String], counts: [usize; 3]) -> Self {
        let mut out = vec![0, 1, 0, 0];
        // The stamp.
        out.resize(12, 0);
        string(&mut out, "");
        number(&mut out, names.len() as u32);
        names.iter().for_each(|name| string(&mut out, name));
        let fields = counts.map(|count| {
            number(&mut out, count as u32);
            if count > 0 {
                pad(&mut out, 8);
            }
            let at = out.len();
            out.resize(at + 8 * count, 0);
            at
        });
        Self { bytes: out, fields }
    }

    /// How long a message is \[bytes\].
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Adds a message: its stamp, and the numbers of each field, as many as were announced.
    pub fn write<'a>(&self, out: &mut Vec<u8>, stamp_ns: i64, fields: [impl Iterator<Item = &'a f64>; 3]) {
        let start = out.len();
        out.extend_from_slice(&self.bytes);
        let message = &mut out[start..];
        message[4..8].copy_from_slice(&(stamp_ns.div_euclid(1_000_000_000) as u32).to_le_bytes());
        message[8..12].copy_from_slice(&(stamp_ns.rem_euclid(1_000_000_000) as u32).to_le_bytes());
        for (at, values) in self.fields.into_iter().zip(fields) {
            let places = message[at..].chunks_exact_mut(8);
            places.zip(values).for_each(|(place, value)| place.copy_from_slice(&value.to_le_bytes()));
        }
    }
}

/// Numbers are aligned to their size, counted from after the first four bytes.
fn pad(out: &mut Vec<u8>, align: usize) {
    let body = out.len() - 4;
    out.resize(4 + body.next_multiple_of(align), 0);
}

fn number(out: &mut Vec<u8>, value: u32) {
    pad(out, 4);
    out.extend(value.to_le_bytes());
}

fn string(out: &mut Vec<u8>, text: &str) {
    number(out, text.len() as u32 + 1);
    out.extend(text.as_bytes());
    out.push(0);
}

/// One message.
#[cfg(test)]
pub(in crate::log) fn joint_state(stamp_ns: i64, names: &[&str], fields: [&[f64]; 3]) -> Vec<u8> {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let mut out = Vec::new();
    JointStateForm::new(&names, fields.map(<[f64]>::len)).write(&mut out, stamp_ns, fields.map(<[f64]>::iter));
    out
}
