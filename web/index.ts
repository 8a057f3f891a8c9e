/**
 * Surfaces that diffract, the material and the layer that show them, and their maps.
 *
 * @module three-diffraction
 */
export { DiffractionError, type DiffractionErrorDetails } from './errors.ts'
export {
  diffractionLayer,
  type BaseMaterial,
  type DiffractionLayer,
  type DiffractionLayerOptions,
  type DiffractionLayerSettings,
} from './layer/diffraction-layer.ts'
export type { Tiles } from './height-field/cut-window.ts'
export type { Axis, Mapping } from './maps/axes.ts'
export { loadSharedMap } from './maps/cache.ts'
export { loadMap, valuesOf, type LoadedMap, type MapArray } from './maps/load.ts'
export type { ArraySpec, Dtype, MapKind, Sidecar } from './maps/sidecar.ts'
export { DiffractionMaterial } from './materials/DiffractionMaterial.ts'
export { lightTexels } from './environment/light-texels.ts'
export type { DiffractionMaterialOptions, Gamut } from './materials/options.ts'
export {
  ProgressiveRefinement,
  type ProgressiveRefinementOptions,
} from './refinement/ProgressiveRefinement.ts'
export type { RefinementFrame } from './refinement/refinement-frame.ts'
export { Foil, type FoilOptions } from './surfaces/foil.ts'
export { HeightField, type HeightFieldOptions } from './surfaces/height-field.ts'
export { Grating, type GratingOptions, type Tracks } from './surfaces/grating.ts'
export type {
  Efficiencies,
  Energy,
  EnvironmentRefinement,
  Feature,
  LightOptics,
  Metal,
  Method,
  Observer,
  Optics,
  OpticsSettings,
  Surface,
} from './surfaces/surface.ts'
