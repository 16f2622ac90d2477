"""The files of CalculiX: the mesh (.inp), the stored matrices (.sti, .mas, .dof), and its modes (.dat, .frd)."""
