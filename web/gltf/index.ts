/**
 * Plugins that write diffracting materials into glTF files and load them.
 *
 * @module three-diffraction/gltf
 */
export {
  GLTFDiffractionExporterPlugin,
  type GLTFDiffractionExporterOptions,
} from './exporter-plugin.ts'
export { EXTENSION } from './fields.ts'
export { GLTFDiffractionLoaderPlugin, type GLTFDiffractionLoaderOptions } from './loader-plugin.ts'
