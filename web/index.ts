export { DiffractionError, type DiffractionErrorDetails } from './errors'
export { loadSharedMap } from './maps/cache'
export { loadMap, valuesOf, type LoadedMap, type MapArray } from './maps/load'
export { DiffractionMaterial } from './materials/DiffractionMaterial'
export { lightTexels } from './environment/light-texels'
export type { DiffractionMaterialOptions, Gamut } from './materials/options'
export {
  ProgressiveRefinement,
  type ProgressiveRefinementOptions,
} from './refinement/ProgressiveRefinement'
export { Foil, type FoilOptions } from './surfaces/foil'
export { HeightField, type HeightFieldOptions } from './surfaces/height-field'
export { Grating, type GratingOptions, type Tracks } from './surfaces/grating'
export type {
  Efficiencies,
  Energy,
  Feature,
  Metal,
  Method,
  Observer,
  Optics,
  OpticsSettings,
  Surface,
} from './surfaces/surface'
