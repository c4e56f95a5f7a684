//! The checksum of MCAP chunks and of zip entries: CRC-32 of ISO-HDLC, eight bytes at a time.

/// Tables for each of eight bytes.
const TABLES: [[u32; 256]; 8] = tables();

const fn tables() -> [[u32; 256]; 8] {
    let mut tables = [[0; 256]; 8];
    let mut n = 0;
    while n < 256 {
        let (mut value, mut bit) = (n as u32, 0);
        while bit < 8 {
            value = if value & 1 == 1 { 0xedb8_8320 ^ (value >> 1) } else { value >> 1 };
            bit += 1;
        }
        tables[0][n] = value;
        n += 1;
    }
    let mut k = 1;
    while k < 8 {
        n = 0;
        while n < 256 {
            let before = tables[k - 1][n];
            tables[k][n] = tables[0][(before & 0xff) as usize] ^ (before >> 8);
            n += 1;
        }
        k += 1;
    }
    tables
}

/// A checksum in the making.
#[derive(Clone, Copy, Debug)]
pub(in crate::log) struct Crc(u32);

impl Default for Crc {
    fn default() -> Self {
        Self(!0)
    }
}

impl Crc {
    /// Of what has been added.
    pub fn value(self) -> u32 {
        !self.0
    }

    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        let mut crc = self.0;
        let mut eights = bytes.chunks_exact(8);
        for eight in &mut eights {
            let low = crc ^ u32::from_le_bytes([eight[0], eight[1], eight[2], eight[3]]);
            let of = |table: usize, byte: u32| TABLES[table][(byte & 0xff) as usize];
            crc = of(7, low) ^ of(6, low >> 8) ^ of(5, low >> 16) ^ of(4, low >> 24);
            crc ^= of(3, u32::from(eight[4])) ^ of(2, u32::from(eight[5]));
            crc ^= of(1, u32::from(eight[6])) ^ of(0, u32::from(eight[7]));
        }
        for byte in eights.remainder() {
            crc = TABLES[0][((crc ^ u32::from(*byte)) & 0xff) as usize] ^ (crc >> 8);
        }
        self.0 = crc;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_standards() {
        // The check value of CRC-32/ISO-HDLC.
        let mut crc = Crc::default();
        crc.add(b"123456789");
        assert_eq!(crc.value(), 0xcbf4_3926);
        let mut parts = Crc::default();
        parts.add(b"1234");
        parts.add(b"56789");
        assert_eq!(parts.value(), crc.value());
    }
}
