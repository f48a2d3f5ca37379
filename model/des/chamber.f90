!> What holds the parcels: a box, what its faces do, walls within it, and gravity.
module chamber
  use kinds, only: wp
  use plane, only: plane_t, new_plane
  use shell, only: shell_t, new_shell
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: chamber_t, face_normal, n_faces

  integer, parameter :: n_faces = 6  !< low and high x, low and high y, low and high z

  !> Faces are numbered 1 to 6: low x, high x, low y, high y, low z, high z. Planes go on with 7, shells after them.
  type :: chamber_t
    real(wp) :: lower(3), upper(3)           !< corners [m]
    logical :: periodic(3) = .false.         !< whether opposite faces are joined
    logical :: open(2, 3) = .false.          !< low and high face of each direction: parcels leave there
    real(wp) :: gravity(3) = 0.0_wp          !< [m/s2]
    integer :: face_material(n_faces) = 0    !< see contact_pairs
    integer :: n_planes = 0, n_shells = 0
    type(plane_t), allocatable :: planes(:)  !< exist if there are any
    type(shell_t), allocatable :: shells(:)  !< exist if there are any
  contains
    procedure :: add_walls
    procedure :: is_wall
    procedure :: material_of
    procedure :: materials
    procedure :: distance
    procedure :: approach_shell
    procedure :: is_beyond
  end type chamber_t

contains

  !> Put walls into the box, which has none yet.
  pure subroutine add_walls(self, settings)
    class(chamber_t), intent(inout) :: self
    type(wall_settings_t), intent(in) :: settings(:)

    integer :: w, p, s

    self%n_planes = count(settings%kind == 'plane')
    self%n_shells = size(settings) - self%n_planes
    if (self%n_planes > 0) allocate (self%planes(self%n_planes))
    if (self%n_shells > 0) allocate (self%shells(self%n_shells))
    p = 0
    s = 0
    do w = 1, size(settings)
      if (settings(w)%kind == 'plane') then
        p = p + 1
        self%planes(p) = new_plane(settings(w))
      else
        s = s + 1
        self%shells(s) = new_shell(settings(w))
      end if
    end do
    if (self%n_shells > 1) call join_shells(self%shells)
  end subroutine add_walls

  !> Find the rims that two shells share.
  pure subroutine join_shells(shells)
    type(shell_t), intent(inout) :: shells(:)

    integer :: s, end, other

    do s = 1, size(shells)
      do end = 1, 2
        do other = size(shells), 1, -1
          if (other == s) cycle
          if (shells(s)%shares_rim(end, shells(other))) shells(s)%joined(end) = other
        end do
      end do
    end do
  end subroutine join_shells

  !> Whether parcels bounce off a face.
  pure function is_wall(self, face)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    logical :: is_wall

    integer :: axis

    axis = (face + 1)/2
    is_wall = .not. (self%periodic(axis) .or. self%open(face - 2*axis + 2, axis))
  end function is_wall

  !> What a wall is made of: see contact_pairs.
  pure function material_of(self, face) result(material)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    integer :: material

    if (face > n_faces + self%n_planes) then
      material = self%shells(face - n_faces - self%n_planes)%material
    else if (face > n_faces) then
      material = self%planes(face - n_faces)%material
    else
      material = self%face_material(face)
    end if
  end function material_of

  !> What all walls are made of.
  pure function materials(self)
    class(chamber_t), intent(in) :: self
    integer, allocatable :: materials(:)

    integer :: face

    materials = pack(self%face_material, [(self%is_wall(face), face=1, n_faces)])
    if (self%n_planes > 0) materials = [materials, self%planes%material]
    if (self%n_shells > 0) materials = [materials, self%shells%material]
  end function materials

  !> Distance of a point from a wall, positive where parcels may be [m].
  pure function distance(self, face, x)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    real(wp) :: way(3)
    integer :: axis

    if (face > n_faces + self%n_planes) then
      call self%approach_shell(face - n_faces - self%n_planes, x, way, distance)
    else if (face > n_faces) then
      distance = self%planes(face - n_faces)%distance(x)
    else
      axis = (face + 1)/2
      if (modulo(face, 2) == 1) then
        distance = x(axis) - self%lower(axis)
      else
        distance = self%upper(axis) - x(axis)
      end if
    end if
  end function distance

  !> The way from the nearest point of a shell, and its length. A rim shared with another shell is felt once, and only
  !> where neither has a point that is nearer: elsewhere the distance is huge.
  pure subroutine approach_shell(self, s, x, way, distance)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: s           !< place in `shells`
    real(wp), intent(in) :: x(3)       !< [m]
    real(wp), intent(out) :: way(3)    !< [m]
    real(wp), intent(out) :: distance  !< [m]

    real(wp) :: other_way(3), other_distance
    integer :: end, other, other_end
    logical :: felt

    call self%shells(s)%approach(x, way, distance, end)
    if (end == 0) return
    other = self%shells(s)%joined(end)
    if (other == 0) return
    call self%shells(other)%approach(x, other_way, other_distance, other_end)
    felt = other_end > 0 .and. s < other
    if (felt) felt = self%shells(other)%joined(other_end) == s
    if (.not. felt) distance = huge(distance)
  end subroutine approach_shell

  !> Whether a parcel is beyond one of the planes or shells, or about to be.
  pure function is_beyond(self, x, radius)
    class(chamber_t), intent(in) :: self
    real(wp), intent(in) :: x(3)    !< [m]
    real(wp), intent(in) :: radius  !< [m]
    logical :: is_beyond

    integer :: m

    is_beyond = .false.
    do m = 1, self%n_planes
      is_beyond = is_beyond .or. .not. self%planes(m)%distance(x) > 0.0_wp
    end do
    do m = 1, self%n_shells
      is_beyond = is_beyond .or. self%shells(m)%is_beyond(self%shells(m)%distance(x), radius)
    end do
  end function is_beyond

  !> Unit vector from a face into the box.
  pure function face_normal(face) result(normal)
    integer, intent(in) :: face
    real(wp) :: normal(3)

    normal = 0.0_wp
    normal((face + 1)/2) = merge(1.0_wp, -1.0_wp, modulo(face, 2) == 1)
  end function face_normal

end module chamber
