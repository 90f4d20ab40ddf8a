-- SPDX-License-Identifier: BSD-3-Clause
-- Schema of `orchard publish` in PostGIS. Created by the first publisher, if permitted to create
-- schemas and extensions, or once by an administrator: psql -f orchard_schema.sql DATABASE.
CREATE EXTENSION IF NOT EXISTS postgis;
CREATE SCHEMA IF NOT EXISTS orchard;

-- One row for each published map.
CREATE TABLE IF NOT EXISTS orchard.visit (
  block text NOT NULL,
  date date NOT NULL,
  num_trees integer NOT NULL,
  source text NOT NULL,
  published_at timestamptz NOT NULL DEFAULT now(),
  published_by text NOT NULL DEFAULT session_user,
  PRIMARY KEY (block, date)
);

-- Trees and objects of all blocks and dates. Lengths in metres; x and y in the map's own frame;
-- place in WGS 84, empty for a map without georeference.
CREATE TABLE IF NOT EXISTS orchard.tree (
  block text NOT NULL,
  date date NOT NULL,
  id integer NOT NULL,
  class text NOT NULL,
  "row" integer,
  "position" integer,
  row_name text,
  tree_name text,
  x_m double precision NOT NULL,
  y_m double precision NOT NULL,
  se_x_m double precision,
  se_y_m double precision,
  width_m double precision,
  width_sd_m double precision,
  probability double precision,
  n integer,
  place geometry(Point, 4326),
  PRIMARY KEY (block, date, id)
);
-- Height of the ground and its standard deviation above the map's datum, empty where unknown. Tables
-- of before have neither.
ALTER TABLE orchard.tree ADD COLUMN IF NOT EXISTS z_m double precision;
ALTER TABLE orchard.tree ADD COLUMN IF NOT EXISTS z_sd_m double precision;
CREATE INDEX IF NOT EXISTS tree_place ON orchard.tree USING gist (place);

-- Rows that a later publication of the same block and date replaced or removed.
CREATE TABLE IF NOT EXISTS orchard.tree_replaced (
  LIKE orchard.tree,
  replaced_at timestamptz NOT NULL DEFAULT now()
);
ALTER TABLE orchard.tree_replaced ADD COLUMN IF NOT EXISTS z_m double precision;
ALTER TABLE orchard.tree_replaced ADD COLUMN IF NOT EXISTS z_sd_m double precision;
CREATE INDEX IF NOT EXISTS tree_replaced_at ON orchard.tree_replaced (block, date, replaced_at);

-- The latest map of each block.
CREATE OR REPLACE VIEW orchard.tree_now AS
  SELECT t.* FROM orchard.tree t
  JOIN (SELECT block, max(date) AS date FROM orchard.visit GROUP BY block) v USING (block, date);

-- Roles for reading and publishing, for example GRANT orchard_reader TO ana;
DO $$
DECLARE role text;
BEGIN
  FOREACH role IN ARRAY ARRAY['orchard_reader', 'orchard_writer'] LOOP
    IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = role) THEN
      EXECUTE format('CREATE ROLE %I NOLOGIN', role);
    END IF;
  END LOOP;
  GRANT USAGE ON SCHEMA orchard TO orchard_reader, orchard_writer;
  GRANT SELECT ON ALL TABLES IN SCHEMA orchard TO orchard_reader, orchard_writer;
  GRANT INSERT, UPDATE, DELETE ON orchard.tree, orchard.visit TO orchard_writer;
  GRANT INSERT ON orchard.tree_replaced TO orchard_writer;
EXCEPTION WHEN insufficient_privilege OR duplicate_object OR unique_violation THEN
  RAISE NOTICE 'the roles orchard_reader and orchard_writer are left to an administrator';
END $$;
