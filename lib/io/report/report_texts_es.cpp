// SPDX-License-Identifier: BSD-3-Clause
#include "io/report/report_texts.hpp"

namespace orchard::io {

const ReportTexts kReportTextsEs = {
    "es",
    ',',
    "Informe del huerto: {}",
    "Recorrido el {}. Orchard Mapper {}.",
    "día desconocido",
    "Qué hay en la parcela",
    "{} árboles en {} filas.",
    "{} árboles más están fuera de las filas.",
    "{} marras (puestos vacíos) entre los árboles de las filas.",
    "{} objetos más, como postes y cajas.",
    "Área de la sección transversal del tronco: {} cm² en total, {} cm² por árbol de media.",
    "El área de la sección transversal del tronco (ASTT) es la del corte que haría una sierra a "
    "través del tronco a la altura del escáner. Crece con el árbol, y con ella se comparan la "
    "cosecha y el vigor.",
    "La parcela",
    "árbol",
    "marra",
    "otro objeto",
    "F",
    "Fila por fila",
    "fila",
    "árboles",
    "marras",
    "marras (número en la fila)",
    "diámetro, cm",
    "ASTT, cm²",
    "± cm²",
    "sin fila",
    "total",
    "Diámetro de los troncos",
    "diámetro del tronco (cm)",
    "árboles",
    "No se conoce el diámetro de ningún tronco.",
    "Marras",
    "No hay ninguna marra.",
    "x; y (m)",
    "número",
    "latitud, longitud",
    "Una marra es un puesto vacío: entre dos árboles vecinos queda sitio para otros.",
    "Qué ha cambiado",
    "Comparado con {} del {}.",
    "cambio",
    "árboles",
    "ya no están",
    "nuevos",
    "en otro sitio",
    "más gruesos",
    "más delgados, u otro árbol",
    "como antes",
    "no se sabe: no los vieron los dos recorridos",
    "Crecimiento",
    "Los diámetros han cambiado {} mm ± {} mm de media. El área de la sección de los {} árboles "
    "medidos las dos veces ha cambiado {} cm².",
    "crecimiento, cm²",
    "crecimiento, %",
    "medidos dos veces",
    "Frente al plano",
    "El plano es {}.",
    "fila del plano",
    "según plano",
    "fuera de sitio",
    "faltan",
    "no vistos",
    "de más",
    "fila desplazada entera",
    "Qué no se vio, y por qué",
    "{} objetos no estuvieron nunca a la vista de la cámara: no se sabe si son árboles, y no se "
    "cuentan.",
    "Todo lo que está en el mapa estuvo a la vista de la cámara.",
    "Durante {} s no hubo imágenes; {} objetos se encontraron entonces por primera vez.",
    "Durante {} s no hubo posición por satélite.",
    "{} árboles del mapa anterior no estuvieron esta vez a la vista.",
    "Mientras se hacía el mapa, el programa avisó (en inglés): {}",
    "Con qué seguridad se sabe",
    "De los árboles, {} son seguros (95 % o más), {} probables (80 % o más) y {} dudosos.",
    "Según la dispersión de sus observaciones, el sitio de un árbol entre sus vecinos se conoce "
    "con "
    "unos {} cm de error (la mitad de los árboles, mejor).",
    "También según su dispersión, el diámetro de un tronco se conoce con unos {} mm de error (la "
    "mitad, mejor).",
    "El ± de estas tablas es solo el de la dispersión. Se le añade lo que es común a todos: en los "
    "diámetros, el error de calibración del escáner, que se anula entre dos recorridos del mismo "
    "robot; en los sitios, el del recorrido del robot.",
};

}  // namespace orchard::io
