//! One array of NumPy (`.npy`, format 1 to 3): numbers or texts, plain or with named fields.

use std::io::{BufReader, Read};

/// The first bytes of an array.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// The description of an array at the most \[bytes\].
const LONGEST_HEAD: usize = 65_536;
/// Joints of one array at the most.
const MOST_JOINTS: u64 = 512;
/// Texts of one array at the most: names of joints.
const MOST_TEXTS: u64 = 4096;
/// Names that Python pickled, at the most \[bytes\].
const LONGEST_PICKLE: u64 = 1 << 20;

/// What items of numbers may be.
pub(super) const READ: &str = "float32, float64, integers and booleans";

/// Rows of numbers, or names.
pub(super) struct Array {
    pub name: String,
    /// What its items are, as NumPy writes it.
    pub descr: String,
    /// Why nothing of it is read.
    pub left_out: Option<&'static str>,
    pub rows: usize,
    /// Column after column; one of a plain list.
    pub values: Vec<Vec<f64>>,
    pub texts: Vec<String>,
}

impl Array {
    /// An array of which nothing is read.
    fn unread(name: &str, descr: String, why: &'static str) -> Self {
        Self { name: name.to_owned(), descr, left_out: Some(why), rows: 0, values: Vec::new(), texts: Vec::new() }
    }

    /// Name and type, and why it is left out.
    pub fn said(&self) -> String {
        let name = if self.name.is_empty() { "the array".to_owned() } else { format!("`{}`", self.name) };
        let why = self.left_out.map_or_else(String::new, |why| format!(", {why}"));
        format!("{name} ({}{why})", self.descr)
    }

    /// Rows as columns.
    pub fn turned(self) -> Self {
        let values = (0..self.rows).map(|row| self.values.iter().map(|column| column[row]).collect());
        Self { rows: self.values.len(), values: values.collect(), ..self }
    }
}

/// Reads an array; each field of one with names is an array of its own, unless one is of a kind that is not used.
/// `size` is what there is at the most \[bytes\], `left` how many numbers may still be read.
///
/// # Errors
/// What is wrong with it, in words.
pub(super) fn read_array(content: impl Read, name: &str, size: u64, left: &mut u64) -> Result<Vec<Array>, String> {
    let mut content = BufReader::with_capacity(1 << 16, content);
    let (shape, length) = head(&mut content)?;
    let unread = |why: &'static str| Ok(vec![Array::unread(name, shape.descr(), why)]);
    let (rows, width) = match shape.dims[..] {
        [rows] => (rows, 1),
        [rows, width] => (rows, width),
        _ => return unread("neither one nor two dimensions"),
    };
    // A joint a row, a sample a column: as good, the other way round.
    let is_turned = width > MOST_JOINTS && rows <= MOST_JOINTS;
    let (rows, width) = if is_turned { (width, rows) } else { (rows, width) };
    let fields = &shape.fields;
    if let [Field { descr, .. }] = &fields[..]
        && descr.ends_with('O')
    {
        let texts = pickled(&mut content, rows.saturating_mul(width))?;
        if texts.is_empty() {
            return unread("objects of Python");
        }
        let (name, descr, rows) = (name.to_owned(), shape.descr(), texts.len());
        return Ok(vec![Array { name, descr, left_out: None, rows, values: Vec::new(), texts }]);
    }
    let kinds: Option<Vec<Kind>> = fields.iter().map(|field| Kind::read(&field.descr)).collect();
    let Some(kinds) = kinds else { return unread("a type that is not read") };
    let of_row = fields.iter().fold(0_u64, |sum, field| sum.saturating_add(field.width)).saturating_mul(width);
    if of_row == 0 {
        return unread("rows without a number");
    }
    let numbers = rows.checked_mul(of_row).filter(|numbers| *numbers <= *left && of_row <= MOST_JOINTS);
    let Some(numbers) = numbers else {
        return Err(format!(
            "{rows} rows of {of_row} numbers are announced, at most {left} in rows of {MOST_JOINTS} are read"
        ));
    };
    let bytes: u64 = fields.iter().zip(&kinds).map(|(field, kind)| field.width * kind.size as u64).sum();
    if rows.saturating_mul(width).saturating_mul(bytes).saturating_add(length as u64) > size {
        return Err(format!("{rows} rows of {of_row} numbers are announced, more than the {size} bytes there are"));
    }
    if kinds.iter().any(|kind| kind.is_text()) && rows.saturating_mul(width) > MOST_TEXTS {
        return unread("more texts than joints have names");
    }
    *left -= numbers;
    let (rows, width) = (rows as usize, width as usize);
    let mut arrays: Vec<Array> = fields.iter().map(|field| field.array(name, rows, width)).collect();
    let by_column = shape.fortran != is_turned;
    let mut item = Vec::new();
    for k in 0..rows * width {
        let column = if by_column && width > 1 { k / rows } else { k % width };
        for ((array, field), kind) in arrays.iter_mut().zip(fields).zip(&kinds) {
            item.resize(kind.size, 0);
            for within in 0..field.width as usize {
                content.read_exact(&mut item).map_err(cut)?;
                if kind.is_text() {
                    array.texts.push(kind.text(&item));
                } else {
                    array.values[column * field.width as usize + within].push(kind.number(&item));
                }
            }
        }
    }
    // What is left is read too, so that a checksum is compared.
    std::io::copy(&mut content, &mut std::io::sink()).map_err(cut)?;
    Ok(arrays)
}

/// Name and type of an array of which nothing else is read.
///
/// # Errors
/// What is wrong with it, in words.
#[cfg(feature = "robots")]
pub(super) fn said_of(mut content: impl Read, name: &str) -> Result<String, String> {
    head(&mut content).map(|(shape, _)| format!("`{name}` ({})", shape.descr()))
}

/// The description that an array begins with, and its length \[bytes\].
fn head(content: &mut impl Read) -> Result<(Shape, usize), String> {
    let mut start = [0; 8];
    content.read_exact(&mut start).map_err(cut)?;
    if &start[..6] != MAGIC {
        return Err("it is no array of NumPy".to_owned());
    }
    let mut length = [0; 4];
    content.read_exact(&mut length[..if start[6] >= 2 { 4 } else { 2 }]).map_err(cut)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST_HEAD {
        return Err(format!("a description of {length} bytes is announced"));
    }
    let mut text = vec![0; length];
    content.read_exact(&mut text).map_err(cut)?;
    Ok((Shape::read(&String::from_utf8_lossy(&text))?, length))
}

/// The last texts of what Python pickled: an array of objects is pickled as a list of what is in it.
fn pickled(content: &mut dyn Read, count: u64) -> Result<Vec<String>, String> {
    let mut bytes = Vec::new();
    content.take(LONGEST_PICKLE).read_to_end(&mut bytes).map_err(cut)?;
    std::io::copy(content, &mut std::io::sink()).map_err(cut)?;
    let mut texts: Vec<String> = Vec::new();
    let mut at = 0;
    while let Some(op) = bytes.get(at) {
        let word = |from: usize, size: usize| {
            let own = bytes.get(from..from + size)?;
            Some(own.iter().rev().fold(0_usize, |value, byte| (value << 8) | usize::from(*byte)))
        };
        // SHORT_BINUNICODE and BINUNICODE are texts; BINPUT, BINGET, BININT1 have a byte of their own, LONG_BINPUT four.
        let text = match op {
            0x8c => word(at + 1, 1).map(|length| (at + 2, length)),
            b'X' => word(at + 1, 4).map(|length| (at + 5, length)),
            _ => None,
        };
        let found = text.and_then(|(from, length)| Some((from + length, bytes.get(from..from.checked_add(length)?)?)));
        at = match (found, op) {
            (Some((after, own)), _) => {
                texts.push(String::from_utf8_lossy(own).into_owned());
                after
            }
            (None, b'q' | b'h' | b'K') => at + 2,
            (None, b'r') => at + 5,
            _ => at + 1,
        };
    }
    let from = texts.len().saturating_sub(usize::try_from(count).unwrap_or(usize::MAX));
    Ok(texts.split_off(from))
}

fn cut(error: std::io::Error) -> String {
    if error.kind() == std::io::ErrorKind::UnexpectedEof { "cut short".to_owned() } else { format!("damaged: {error}") }
}

/// A part of every item.
struct Field {
    /// Empty: the item is the only one.
    name: String,
    descr: String,
    /// Numbers of it in an item.
    width: u64,
}

impl Field {
    fn array(&self, of: &str, rows: usize, width: usize) -> Array {
        let name = if self.name.is_empty() { of.to_owned() } else { self.name.clone() };
        let (descr, values) = (self.descr.clone(), vec![Vec::new(); width * self.width as usize]);
        Array { name, descr, left_out: None, rows, values, texts: Vec::new() }
    }
}

/// The description of an array.
struct Shape {
    fields: Vec<Field>,
    fortran: bool,
    dims: Vec<u64>,
}

impl Shape {
    /// What the items are.
    fn descr(&self) -> String {
        let of_fields: Vec<String> =
            self.fields.iter().map(|field| format!("{} {}", field.name, field.descr).trim_start().to_owned()).collect();
        of_fields.join(", ")
    }

    fn read(text: &str) -> Result<Self, String> {
        let after = |key: &str| text.find(key).map(|at| text[at + key.len()..].trim_start_matches([' ', ':']));
        let damaged = || "damaged: its description cannot be read".to_owned();
        let descr = after("'descr'").ok_or_else(damaged)?;
        let fields = match descr.strip_prefix('[') {
            Some(list) => fields(list).ok_or_else(damaged)?,
            None => {
                let (descr, _) = quoted(descr).ok_or_else(damaged)?;
                vec![Field { name: String::new(), descr: descr.to_owned(), width: 1 }]
            }
        };
        let fortran = after("'fortran_order'").ok_or_else(damaged)?.starts_with("True");
        let (dims, _) =
            after("'shape'").and_then(|rest| rest.strip_prefix('(')?.split_once(')')).ok_or_else(damaged)?;
        let dims = dims.split(',').map(str::trim).filter(|part| !part.is_empty());
        let dims: Vec<u64> = dims.map(str::parse).collect::<Result<_, _>>().map_err(|_| damaged())?;
        Ok(Self { fields, fortran, dims })
    }
}

/// A word in quotes, and what follows it.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start_matches([' ', ',']);
    let mark = text.chars().next().filter(|mark| matches!(mark, '\'' | '"'))?;
    text[1..].split_once(mark)
}

/// Fields of a structured array: `('t', '<f8'), ('q', '<f8', (6,))]`.
fn fields(list: &str) -> Option<Vec<Field>> {
    let (mut fields, mut rest) = (Vec::new(), list);
    while let Some(own) = rest.trim_start_matches([' ', ',']).strip_prefix('(') {
        let (name, own) = quoted(own)?;
        let (descr, own) = quoted(own)?;
        let own = own.trim_start_matches([' ', ',']);
        let (width, own) = match own.strip_prefix('(') {
            Some(own) => {
                let (dims, own) = own.split_once(')')?;
                let dims = dims.split(',').map(str::trim).filter(|part| !part.is_empty());
                let width =
                    dims.map(|part| part.parse::<u64>().ok()).try_fold(1_u64, |product, n| product.checked_mul(n?))?;
                (width.min(MOST_JOINTS + 1), own)
            }
            None => (1, own),
        };
        fields.push(Field { name: name.to_owned(), descr: descr.to_owned(), width });
        rest = own.trim_start().strip_prefix(')')?;
    }
    (!fields.is_empty() && fields.len() <= MOST_JOINTS as usize).then_some(fields)
}

/// What an item of an array is.
#[derive(Clone, Copy)]
struct Kind {
    letter: u8,
    size: usize,
    is_big: bool,
}

impl Kind {
    fn read(descr: &str) -> Option<Self> {
        let (order, rest) = descr.split_at_checked(1)?;
        let (letter, count) = rest.split_at_checked(1)?;
        let (letter, count) = (letter.as_bytes()[0], count.parse::<usize>().ok()?);
        let is_known = match letter {
            b'f' => matches!(count, 4 | 8),
            b'i' | b'u' => matches!(count, 1 | 2 | 4 | 8),
            b'b' => count == 1,
            b'U' | b'S' => count <= 256,
            _ => false,
        };
        let size = if letter == b'U' { 4 * count } else { count };
        (is_known && size > 0).then_some(Self { letter, size, is_big: order == ">" })
    }

    fn is_text(self) -> bool {
        matches!(self.letter, b'U' | b'S')
    }

    fn number(self, item: &[u8]) -> f64 {
        let mut bytes = [0; 8];
        for (k, byte) in item.iter().enumerate() {
            bytes[if self.is_big { item.len() - 1 - k } else { k }] = *byte;
        }
        let whole = u64::from_le_bytes(bytes);
        match (self.letter, self.size) {
            (b'f', 4) => f64::from(f32::from_bits(whole as u32)),
            (b'f', _) => f64::from_bits(whole),
            (b'i', size) => {
                let unused = 64 - 8 * size as u32;
                ((whole << unused) as i64 >> unused) as f64
            }
            _ => whole as f64,
        }
    }

    fn text(self, item: &[u8]) -> String {
        if self.letter == b'S' {
            return String::from_utf8_lossy(item).trim_end_matches('\0').to_owned();
        }
        let codes = item.chunks_exact(4).map(|code| {
            let code: [u8; 4] = code.try_into().unwrap_or_default();
            if self.is_big { u32::from_be_bytes(code) } else { u32::from_le_bytes(code) }
        });
        codes.take_while(|code| *code != 0).map(|code| char::from_u32(code).unwrap_or('?')).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(description: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((description.len() as u16).to_le_bytes());
        bytes.extend(description.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read(description: &str, data: &[u8]) -> Result<Vec<Array>, String> {
        let bytes = npy(description, data);
        read_array(&bytes[..], "a", bytes.len() as u64, &mut 1000)
    }

    #[test]
    fn fields_are_arrays_of_their_own() {
        let mut data = Vec::new();
        for row in [[0.0_f64, 1.0, 2.0], [0.5, 3.0, 4.0]] {
            row.iter().for_each(|value| data.extend(value.to_be_bytes()));
        }
        let text = "{'descr': [('t', '>f8'), ('q', '>f8', (2,))], 'fortran_order': False, 'shape': (2,), }";
        let arrays = read(text, &data).unwrap();
        assert_eq!((arrays[0].name.as_str(), &arrays[0].values[..]), ("t", &[vec![0.0, 0.5]][..]));
        assert_eq!((arrays[1].name.as_str(), &arrays[1].values[..]), ("q", &[vec![1.0, 3.0], vec![2.0, 4.0]][..]));
    }

    #[test]
    fn names_of_objects_are_read_and_absurd_sizes_refused() {
        let pickle = b"\x80\x04\x8c\x05numpy\x94\x8c\x07ndarray\x94](\x8c\x01a\x94\x8c\x02bc\x94e.";
        let text = "{'descr': '|O', 'fortran_order': False, 'shape': (2,), }";
        assert_eq!(read(text, pickle).unwrap()[0].texts, ["a", "bc"]);
        for shape in ["(1000000000000,)", "(3,)", "(3, 400)"] {
            let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
            assert!(read(&text, &[0; 8]).is_err_and(|what| what.contains("announced")), "{shape}");
        }
        let none = read("{'descr': [('a', '<f8', (0,))], 'fortran_order': False, 'shape': (99999999999,), }", &[]);
        assert!(none.unwrap()[0].left_out.is_some());
        assert!(read("{'descr': [('a'", &[]).is_err());
    }

    #[test]
    fn what_is_not_read_is_there_with_its_type_and_why() {
        for (descr, shape, why) in [
            ("<f2", "(4,)", "a type that is not read"),
            ("<c16", "(4,)", "a type that is not read"),
            ("<f8", "(4, 2, 2)", "neither one nor two dimensions"),
            ("|O", "(0,)", "objects of Python"),
        ] {
            let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
            let arrays = read(&text, &[]).unwrap();
            assert_eq!((arrays[0].said(), arrays.len()), (format!("`a` ({descr}, {why})"), 1));
        }
    }

    #[test]
    fn joints_in_rows_are_turned() {
        let data: Vec<u8> = (0..1200).flat_map(|k| (k as f32).to_le_bytes()).collect();
        let mut left = 2000;
        let bytes = npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 600), }", &data);
        let arrays = read_array(&bytes[..], "q", bytes.len() as u64, &mut left).unwrap();
        assert_eq!((arrays[0].rows, arrays[0].values[1][..2].to_vec(), left), (600, vec![600.0, 601.0], 800));
    }
}
