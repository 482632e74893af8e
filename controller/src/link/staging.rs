//! An upload on its way: it is looked at only when it is whole and its hash is right.

use sutura_shared::codec::{self, DecodeError};
use sutura_shared::hash::Fnv1a;
use sutura_shared::message::{SceneBegin, SceneChunk, SceneCommit, UploadError};
use sutura_shared::scene::Scene;

/// Where an upload grows.
pub(super) struct Staging<'m> {
    buffer: &'m mut [u8],
    upload: Option<Upload>,
}

#[derive(Clone, Copy)]
struct Upload {
    begin: SceneBegin,
    /// Bytes that have come in order.
    filled: usize,
    /// Whole, and to be taken after this tick.
    apply_at_tick: Option<u32>,
}

/// A refused upload: the reason and what is wrong or would be right.
pub(super) type Refusal = (UploadError, &'static str);

impl<'m> Staging<'m> {
    pub(super) const fn new(buffer: &'m mut [u8]) -> Self {
        Self { buffer, upload: None }
    }

    /// Drops any upload.
    pub(super) const fn clear(&mut self) {
        self.upload = None;
    }

    /// Bytes that have come in order.
    pub(super) fn offset(&self) -> u32 {
        self.upload.map_or(0, |upload| upload.filled as u32)
    }

    pub(super) fn begin(&mut self, begin: SceneBegin) -> Result<(), Refusal> {
        self.upload = None;
        if length(&begin) > self.buffer.len() {
            return Err((UploadError::TooLong, "the controller's staging buffer is smaller"));
        }
        self.upload = Some(Upload {
            begin,
            filled: 0,
            apply_at_tick: None,
        });
        Ok(())
    }

    pub(super) fn chunk(&mut self, chunk: &SceneChunk<'_>) -> Result<(), Refusal> {
        let upload = self.upload(chunk.transfer)?;
        let end = upload.filled + chunk.data.len();
        if chunk.offset as usize != upload.filled || end > length(&upload.begin) {
            return Err((UploadError::Order, "parts in order, without gaps, to the end"));
        }
        if let Some(place) = self.buffer.get_mut(upload.filled..end) {
            place.copy_from_slice(chunk.data);
        }
        self.upload = Some(Upload { filled: end, ..upload });
        Ok(())
    }

    /// Marks the upload as whole, to be taken after its tick; `tick` was the last.
    pub(super) fn commit(&mut self, commit: &SceneCommit, tick: u32) -> Result<(), Refusal> {
        let upload = self.upload(commit.transfer)?;
        let bytes = self.buffer.get(..upload.filled).unwrap_or_default();
        let hash = Fnv1a::new().bytes(bytes).get();
        if upload.filled != length(&upload.begin) {
            return Err((UploadError::Order, "the end is missing"));
        }
        if hash != upload.begin.hash || hash != commit.hash {
            return Err((UploadError::Hash, "the hash of all bytes"));
        }
        if commit.apply_at_tick < tick {
            return Err((UploadError::Late, "apply_at_tick not in the past"));
        }
        self.upload = Some(Upload {
            apply_at_tick: Some(commit.apply_at_tick),
            ..upload
        });
        Ok(())
    }

    /// The number of the upload that is to be taken after `tick`.
    pub(super) fn due(&self, tick: u32) -> Option<SceneBegin> {
        self.upload
            .filter(|upload| upload.apply_at_tick == Some(tick))
            .map(|upload| upload.begin)
    }

    /// The scene and its cells, valid.
    pub(super) fn scene(&self, begin: &SceneBegin) -> Result<(Scene, &[u8]), Refusal> {
        let whole = self.buffer.get(..length(begin)).unwrap_or_default();
        let (scene, cells) = whole.split_at_checked(begin.scene_len as usize).unwrap_or_default();
        let scene: Scene = codec::decode(scene).map_err(|error| match error {
            DecodeError::Invalid(invalid) => (UploadError::Value, invalid.field),
            DecodeError::Malformed | DecodeError::Trailing | DecodeError::NotCanonical => {
                (UploadError::Encoding, "a scene and its cells")
            }
        })?;
        scene
            .validate_cells(cells)
            .map_err(|invalid| (UploadError::Value, invalid.field))?;
        Ok((scene, cells))
    }

    fn upload(&self, transfer: u8) -> Result<Upload, Refusal> {
        self.upload
            .filter(|upload| upload.begin.transfer == transfer && upload.apply_at_tick.is_none())
            .ok_or((UploadError::Transfer, "an upload that was announced"))
    }
}

const fn length(begin: &SceneBegin) -> usize {
    begin.scene_len as usize + begin.cells_len as usize
}
