"""Findings and figures for people and programs: json, csv, html, terminal."""
