// Materials and pictures, as MuJoCo maps them: those of a cube by the direction from the middle of a solid.

import { CanvasTexture, CubeTexture, MeshLambertMaterial, MeshPhongMaterial, RepeatWrapping, SRGBColorSpace } from "three";

const GLOSS = { specular: 0x555555, shininess: 60 };

export async function readTextures(described) {
  return Promise.all(
    described.map(async ({ cube, png }) => {
      const image = await createImageBitmap(new Blob([png.values], { type: "image/png" }));
      return cube ? cubeOf(image) : flatOf(image);
    }),
  );
}

function cubeOf(image) {
  const size = image.width;
  const sides = Array.from({ length: 6 }, (_, side) => {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = size;
    canvas.getContext("2d").drawImage(image, 0, -side * size);
    return canvas;
  });
  const texture = new CubeTexture(sides);
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

function flatOf(image) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width, image.height];
  canvas.getContext("2d").drawImage(image, 0, 0);
  const texture = new CanvasTexture(canvas);
  texture.flipY = false; // MuJoCo's pictures begin at the top as well.
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.colorSpace = SRGBColorSpace;
  return texture;
}

// One material of three.js for each of MuJoCo's; where there is none, geoms have a colour of their own.
export function makeMaterials(described, textures) {
  return described.map(({ name, rgba, texture, repeat }) => {
    const picture = texture === null ? null : textures[texture];
    const material = plainMaterial(rgba, name.startsWith("eye"));
    if (picture?.isCubeTexture) mapCube(material, picture);
    else if (picture) {
      material.map = picture.clone();
      material.map.repeat.set(...repeat);
      material.map.needsUpdate = true;
    }
    return material;
  });
}

export function plainMaterial([red, green, blue, opacity], glossy = false) {
  const looks = { transparent: opacity < 1, opacity };
  const material = glossy ? new MeshPhongMaterial({ ...looks, ...GLOSS }) : new MeshLambertMaterial(looks);
  material.color.setRGB(red, green, blue, SRGBColorSpace);
  return material;
}

function mapCube(material, texture) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.sides = { value: texture };
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec3 vAway;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvAway = position;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying vec3 vAway;\nuniform samplerCube sides;")
      .replace("#include <map_fragment>", "diffuseColor *= textureCube(sides, vAway);");
  };
  material.customProgramCacheKey = () => "cube";
}
