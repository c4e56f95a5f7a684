//! The pages of a column of a Parquet file, in an order in which they can be decoded.

use parquet::basic::Encoding;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::column::reader::{ColumnReader, get_column_reader};
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::RowGroupReader;

/// A column of a row group; a file that places a column before its beginning, or whose pages are out of order, is an error,
/// where the crate's own reader panics.
pub(super) fn column(group: &dyn RowGroupReader, at: usize) -> Result<ColumnReader> {
    let chunk = group.metadata().column(at);
    let start = chunk.dictionary_page_offset().unwrap_or_else(|| chunk.data_page_offset());
    if start < 0 || chunk.compressed_size() < 0 {
        return Err(ParquetError::General("a column begins before the file, or is shorter than nothing".to_owned()));
    }
    let pages = InOrder { pages: group.get_column_page_reader(at)?, has_dictionary: false };
    Ok(get_column_reader(group.metadata().column(at).column_descr_ptr(), Box::new(pages)))
}

/// Pages of which those that refer to a dictionary come after it.
struct InOrder {
    pages: Box<dyn PageReader>,
    has_dictionary: bool,
}

impl Iterator for InOrder {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for InOrder {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        match &page {
            Some(Page::DictionaryPage { .. }) => self.has_dictionary = true,
            Some(Page::DataPage { encoding, .. } | Page::DataPageV2 { encoding, .. }) => {
                let refers = matches!(encoding, Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY);
                if refers && !self.has_dictionary {
                    return Err(ParquetError::General("a page refers to a dictionary that is not there".to_owned()));
                }
            }
            None => {}
        }
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.pages.skip_next_page()
    }
}
