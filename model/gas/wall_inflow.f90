!> Gas that comes in through the walls within the domain: porous ones, or nozzles too small for the grid.
!>
!> Of the cells whose middle a record holds, the wall lets it in, across itself and everywhere at the same superficial velocity.
module wall_inflow
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t
  use kinds, only: wp
  use mesh, only: mesh_t
  use open_space, only: open_space_t
  implicit none
  private
  public :: wall_inflow_t, find_wall_inflow

  type :: wall_inflow_t
    integer, allocatable :: record(:,:,:)    !< (n1,n2,n3) to which the wall of a cell belongs, 0 for none
    real(wp), allocatable :: area(:,:,:)     !< of that wall [m2]
    real(wp), allocatable :: flow(:,:,:)     !< superficial velocity into the gas [m/s]
    real(wp), allocatable :: nominal(:,:,:)  !< the same where factors are 1
  contains
    procedure :: settle
    procedure :: multiply
  end type wall_inflow_t

contains

  !> Which record has the wall of each cell of my box. The last of several wins, after `overlap` has told of them.
  pure subroutine find_wall_inflow(boxes, mesh, records, space, walls, overlap)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    type(open_space_t), intent(in) :: space
    type(wall_inflow_t), intent(out) :: walls
    integer, intent(inout) :: overlap  !< which two records hold one wall: first + (second - 1)*size(records)

    integer :: i, j, k, m
    real(wp) :: x(3)

    associate (n => boxes%n)
      allocate (walls%record(n(1), n(2), n(3)), source=0)
      allocate (walls%area(n(1), n(2), n(3)), source=space%wall(1:n(1), 1:n(2), 1:n(3)))
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            if (.not. space%wall(i, j, k) > 0.0_wp .or. space%closed(i, j, k)) cycle
            x = mesh%in_metres(boxes%lo + [i, j, k] - 1.5_wp)
            do m = 1, size(records)
              if (records(m)%surface /= 'walls' .or. .not. records(m)%holds(x, mesh%finest)) cycle
              if (walls%record(i, j, k) /= 0) overlap = walls%record(i, j, k) + (m - 1)*size(records)
              walls%record(i, j, k) = m
            end do
          end do
        end do
      end do
    end associate
    where (walls%record == 0) walls%area = 0.0_wp
  end subroutine find_wall_inflow

  !> Give the walls of each record its velocity.
  pure subroutine settle(self, speed)
    class(wall_inflow_t), intent(inout) :: self
    real(wp), intent(in) :: speed(:)  !< (records) [m/s]

    integer :: m

    allocate (self%flow, mold=self%area)
    self%flow = 0.0_wp
    do m = 1, size(speed)
      where (self%record == m) self%flow = speed(m)
    end do
    self%nominal = self%flow
  end subroutine settle

  !> The inflow of one record times a factor.
  pure subroutine multiply(self, m, factor)
    class(wall_inflow_t), intent(inout) :: self
    integer, intent(in) :: m
    real(wp), intent(in) :: factor

    where (self%record == m) self%flow = factor*self%nominal
  end subroutine multiply

end module wall_inflow
