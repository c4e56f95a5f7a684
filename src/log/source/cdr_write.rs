//! Messages as they are written to MCAP.

/// A JointState in little-endian CDR.
pub(in crate::log) fn joint_state(stamp_ns: i64, names: &[&str], fields: [&[f64]; 3]) -> Vec<u8> {
    let mut out = vec![0, 1, 0, 0];
    let pad = |out: &mut Vec<u8>, align: usize| {
        let body = out.len() - 4;
        out.resize(4 + body.next_multiple_of(align), 0);
    };
    let number = |out: &mut Vec<u8>, value: u32| {
        pad(out, 4);
        out.extend(value.to_le_bytes());
    };
    let string = |out: &mut Vec<u8>, text: &str| {
        number(out, text.len() as u32 + 1);
        out.extend(text.as_bytes());
        out.push(0);
    };
    number(&mut out, stamp_ns.div_euclid(1_000_000_000) as u32);
    number(&mut out, stamp_ns.rem_euclid(1_000_000_000) as u32);
    string(&mut out, "");
    number(&mut out, names.len() as u32);
    names.iter().for_each(|name| string(&mut out, name));
    for field in fields {
        number(&mut out, field.len() as u32);
        if !field.is_empty() {
            pad(&mut out, 8);
        }
        field.iter().for_each(|value| out.extend(value.to_le_bytes()));
    }
    out
}
