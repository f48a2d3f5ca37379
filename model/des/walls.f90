!> Contacts of parcels with the plane faces of the chamber.
!>
!> A wall is a partner of infinite mass and no radius or curvature in the parcel's foot point on the plane; the law is the one
!> of parcels, with the constants of the wall.
module walls
  use contact_lanes, only: lanes
  use contact_law, only: contact_law_t, friction_forces, frictionless_forces
  use contact_list, only: never
  use kinds, only: wp
  use parcels, only: parcels_t
  use chamber, only: chamber_t, face_normal, n_faces
  implicit none
  private
  public :: wall_list_t

  integer, parameter :: block_pairs = 64  !< contacts given to the law at a time

  !> Parcels that touch a wall or may do so before the list is made again, ordered by column.
  type :: wall_list_t
    logical :: with_history = .false.
    integer :: entries = 0
    integer :: through = 0                !< column of a parcel whose centre is beyond a wall, 0 if there is none
    integer, allocatable :: parcel(:)     !< (entries) column
    integer, allocatable :: face(:)       !< (entries) see chamber
    real(wp), allocatable :: slip(:,:)    !< (4, entries) 1:3 tangential slip [m], 4 step of last touch
  contains
    procedure :: build
    procedure :: sweep
  end type wall_list_t

contains

  !> List the parcels whose surface is within `margin` of a wall.
  subroutine build(self, chamber, parcels, margin)
    class(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: margin  !< [m]

    integer :: i, face, n

    n = 0
    if (.not. allocated(self%parcel)) allocate (self%parcel(64), self%face(64))
    do i = 1, parcels%n
      if (n + n_faces > size(self%parcel)) then
        self%parcel = [self%parcel, self%parcel]
        self%face = [self%face, self%face]
      end if
      associate (s => parcels%state(1:4, i))
        if (all(s(1:3) - chamber%lower > s(4) + margin) .and. all(chamber%upper - s(1:3) > s(4) + margin)) cycle
        do face = 1, n_faces
          if (.not. chamber%is_wall(face)) cycle
          if (chamber%distance(face, s(1:3)) > s(4) + margin) cycle
          n = n + 1
          self%parcel(n) = i
          self%face(n) = face
        end do
      end associate
    end do
    self%entries = n
    if (.not. self%with_history) return
    if (allocated(self%slip)) deallocate (self%slip)
    allocate (self%slip(4, n))
    self%slip(1:3, :) = 0.0_wp
    self%slip(4, :) = never
  end subroutine build

  !> Add the forces and torques of all walls.
  pure subroutine sweep(self, chamber, law, parcels)
    class(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_law_t), intent(in) :: law
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: pair(8, block_pairs), d
    integer :: touching(block_pairs), n, w

    n = 0
    self%through = 0
    do w = 1, self%entries
      associate (s => parcels%state(1:8, self%parcel(w)), face => self%face(w))
        d = chamber%distance(face, s(1:3))
        if (.not. d > 0.0_wp) then
          self%through = self%parcel(w)
        else if (d < s(4)) then
          n = n + 1
          touching(n) = w
          pair(1:3, n) = d*face_normal(face)
          pair(4:8, n) = s(4:8)
        end if
      end associate
      if (n == block_pairs) then
        call apply(self, law, touching(1:n), pair, parcels)
        n = 0
      end if
    end do
    if (n > 0) call apply(self, law, touching(1:n), pair, parcels)
  end subroutine sweep

  !> Forces of a block of contacts with walls. Lanes left over repeat the last contact.
  pure subroutine apply(self, law, touching, pair, parcels)
    class(wall_list_t), intent(inout) :: self
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: touching(:)                 !< (n) entries
    real(wp), intent(inout) :: pair(8, block_pairs)    !< see contact_linear
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: spin(4, block_pairs), slip(4, block_pairs), force(8, block_pairs)
    real(wp) :: push(4, block_pairs), curvature(block_pairs)
    integer :: n, m, i, full

    n = size(touching)
    full = lanes*((n + lanes - 1)/lanes)
    do m = n + 1, full
      pair(:, m) = pair(:, n)
    end do
    if (.not. self%with_history) then
      curvature(1:full) = 1/pair(4, 1:full)
      call frictionless_forces(law, full, pair, curvature, push)
      do m = 1, n
        i = self%parcel(touching(m))
        parcels%force(1:3, i) = parcels%force(1:3, i) + push(1:3, m)
      end do
      return
    end if
    do m = 1, full
      spin(:, m) = parcels%state(9:12, self%parcel(touching(min(m, n))))
      slip(:, m) = self%slip(:, touching(min(m, n)))
    end do
    call friction_forces(law, full, pair, spin, slip, force)
    do m = 1, n
      i = self%parcel(touching(m))
      self%slip(:, touching(m)) = slip(:, m)
      parcels%force(:, i) = parcels%force(:, i) + force(:, m)
    end do
  end subroutine apply

end module walls
