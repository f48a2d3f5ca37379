!> What records say of the walls within the domain: where the gas slips along them, comes in through them (porous ones, or nozzles
!> too small for the grid) or leaves through them (filters).
!>
!> A record holds the walls of the cells whose middle its box holds. What comes in does so across the wall, everywhere at the same
!> superficial velocity. Where it leaves, the pressure of the cell is given and nothing rubs; what comes back has the velocity of
!> the gas that is there.
module inner_walls
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t
  use constants, only: is_set
  use kinds, only: wp
  use mesh, only: mesh_t
  use open_shares, only: find_cell
  use open_space, only: open_space_t
  implicit none
  private
  public :: inner_walls_t, find_inner_walls

  type :: inner_walls_t
    integer, allocatable :: record(:,:,:)    !< (0:n1+1,0:n2+1,0:n3+1) to which the wall of a cell belongs, 0 for none
    real(wp), allocatable :: area(:,:,:)     !< (n1,n2,n3) of that wall [m2]
    real(wp), allocatable :: flow(:,:,:)     !< superficial velocity into the gas [m/s]
    real(wp), allocatable :: nominal(:,:,:)  !< the same where factors are 1
    logical :: feed = .false.                !< whether gas comes in through any, on any rank
    logical, allocatable :: slips(:,:,:)     !< as record: whether it does not hold the gas; exists if any does not
    logical, allocatable :: vents(:,:,:)     !< as record: whether it is an outflow; exists if any is
    real(wp), allocatable :: pressure(:,:,:)  !< there [Pa]
  contains
    procedure :: areas
    procedure :: settle
    procedure :: multiply
  end type inner_walls_t

contains

  !> Which record has the wall of each cell of my box and its halo. The last of several wins, after `overlap` has told of them.
  pure subroutine find_inner_walls(boxes, mesh, records, space, walls, overlap)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    type(open_space_t), intent(in) :: space
    type(inner_walls_t), intent(out) :: walls
    integer, intent(inout) :: overlap  !< which two records hold one wall: first + (second - 1)*size(records)

    integer :: i, j, k, m
    real(wp) :: corner(3), h(3)

    associate (n => boxes%n)
      allocate (walls%record(0:n(1) + 1, 0:n(2) + 1, 0:n(3) + 1), source=0)
      do k = 0, n(3) + 1
        do j = 0, n(2) + 1
          do i = 0, n(1) + 1
            if (.not. (space%wall(i, j, k) > 0.0_wp .and. space%volume(i, j, k) > 0.0_wp)) cycle
            call find_cell(boxes, mesh, [i, j, k], corner, h)
            do m = 1, size(records)
              if (records(m)%surface /= 'walls' .or. .not. records(m)%holds(corner + 0.5_wp*h, mesh%finest)) cycle
              if (walls%record(i, j, k) /= 0) overlap = walls%record(i, j, k) + (m - 1)*size(records)
              walls%record(i, j, k) = m
            end do
          end do
        end do
      end do
      allocate (walls%area(n(1), n(2), n(3)), source=space%wall(1:n(1), 1:n(2), 1:n(3)))
      where (walls%record(1:n(1), 1:n(2), 1:n(3)) == 0) walls%area = 0.0_wp
    end associate
  end subroutine find_inner_walls

  !> That of the walls of each record on this rank [m2].
  pure function areas(self, records)
    class(inner_walls_t), intent(in) :: self
    integer, intent(in) :: records
    real(wp) :: areas(records)

    integer :: m

    areas = [(sum(self%area, mine(self) == m), m=1, records)]
  end function areas

  !> Give the walls of each record what it says.
  pure subroutine settle(self, records, speed, reference)
    class(inner_walls_t), intent(inout) :: self
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: speed(:)   !< (records) [m/s]
    real(wp), intent(in) :: reference  !< pressure where a record gives none [Pa]

    integer :: m

    allocate (self%flow, source=0.0_wp*self%area)
    do m = 1, size(records)
      if (records(m)%surface /= 'walls') cycle
      select case (records(m)%kind)
      case ('inflow')
        self%feed = self%feed .or. speed(m) > 0.0_wp
        where (mine(self) == m) self%flow = speed(m)
      case ('slip')
        call mark(self, m, self%slips)
      case ('outflow')
        call mark(self, m, self%slips)
        call mark(self, m, self%vents)
        if (.not. allocated(self%pressure)) allocate (self%pressure, source=0.0_wp*self%area + reference)
        if (.not. is_set(records(m)%pressure)) cycle
        where (mine(self) == m) self%pressure = records(m)%pressure
      case default  ! the gas sticks to it
      end select
    end do
    self%nominal = self%flow
  end subroutine settle

  !> Add the walls of a record to those of a kind.
  pure subroutine mark(self, m, marked)
    class(inner_walls_t), intent(in) :: self
    integer, intent(in) :: m
    logical, allocatable, intent(inout) :: marked(:,:,:)

    if (.not. allocated(marked)) then
      allocate (marked(0:ubound(self%record, 1), 0:ubound(self%record, 2), 0:ubound(self%record, 3)), source=.false.)
    end if
    marked = marked .or. self%record == m
  end subroutine mark

  !> The inflow of one record times a factor.
  pure subroutine multiply(self, m, factor)
    class(inner_walls_t), intent(inout) :: self
    integer, intent(in) :: m
    real(wp), intent(in) :: factor

    where (mine(self) == m) self%flow = factor*self%nominal
  end subroutine multiply

  !> The records of the cells of my box.
  pure function mine(self) result(record)
    class(inner_walls_t), intent(in) :: self
    integer :: record(size(self%area, 1), size(self%area, 2), size(self%area, 3))

    associate (n => shape(self%area))
      record = self%record(1:n(1), 1:n(2), 1:n(3))
    end associate
  end function mine

end module inner_walls
