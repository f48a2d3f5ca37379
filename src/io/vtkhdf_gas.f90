!> The file of the gas, gas.vtkhdf: fields on the cells of the grid at every output time, as VTK's temporal ImageData
!> or, of a graded grid, RectilinearGrid (VTKHDF 2.7, from ParaView 6.1 on); gas.xmf beside it serves older ParaView.
!>
!>   call gas%open(name, boxes, mesh, origin, outcome, after)
!>   call gas%begin_step(time)
!>   call gas%add('void_fraction', eps, '1')      any number of fields, the same in every step
!>   call gas%end_step(outcome)
!>   call gas%close(outcome)
!>
!> Real numbers are stored in single precision and compressed.
module vtkhdf_gas
  use agreement, only: agree
  use boxes, only: boxes_t
  use hdf5_arrays, only: put_block, put_attribute, put_columns
  use hdf5_file, only: single_kind, real_kind
  use kinds, only: wp, sp, i8
  use mesh, only: mesh_t
  use outcome, only: outcome_t
  use provenance, only: provenance_t
  use vtkhdf_steps, only: vtkhdf_t, put_row, whole
  use xdmf, only: write_grid_sidecar
  implicit none
  private
  public :: vtkhdf_gas_t

  character(len=*), parameter :: cell_data = '/VTKHDF/CellData/', of_steps = '/VTKHDF/Steps/'
  character(len=*), parameter :: coordinates(3) = ['XCoordinates', 'YCoordinates', 'ZCoordinates']

  type, extends(vtkhdf_t) :: vtkhdf_gas_t
    private
    integer :: lower(3)          !< first cell of my box
    integer(i8) :: largest(3)    !< cells of the largest box, the piece in which fields are stored
    type(mesh_t) :: mesh
  contains
    procedure :: open => open_gas
    procedure :: begin_step
    procedure, private :: add_scalars, add_vectors
    generic :: add => add_scalars, add_vectors
    procedure :: end_step
    procedure :: close => close_gas
  end type vtkhdf_gas_t

contains

  !> Begin the file, or go on with that of the run which is continued at the time `after`.
  subroutine open_gas(self, name, boxes, mesh, origin, outcome, after)
    class(vtkhdf_gas_t), intent(out) :: self
    character(len=*), intent(in) :: name      !< ending in .vtkhdf
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(provenance_t), intent(in) :: origin
    type(outcome_t), intent(inout) :: outcome
    real(wp), intent(in), optional :: after   !< [s]

    logical :: fresh
    integer :: a

    self%lower = boxes%lo
    do a = 1, 3
      self%largest(a) = boxes%comm%max(boxes%n(a))
    end do
    self%mesh = mesh
    call self%start(name, boxes%comm, after, fresh)
    if (boxes%comm%is_root() .and. fresh .and. mesh%uniform) call introduce_image(self, origin)
    if (boxes%comm%is_root() .and. fresh .and. .not. mesh%uniform) call introduce_graded(self, origin)
    call self%started(outcome)
  end subroutine open_gas

  subroutine introduce_image(self, origin)
    class(vtkhdf_gas_t), intent(inout) :: self
    type(provenance_t), intent(in) :: origin

    call self%introduce('ImageData', [2, 0], origin)
    associate (n => self%mesh%n)
      call put_attribute(self%file, '/VTKHDF', 'WholeExtent', [0, n(1), 0, n(2), 0, n(3)])
    end associate
    call put_attribute(self%file, '/VTKHDF', 'Origin', self%mesh%lower)
    call put_attribute(self%file, '/VTKHDF', 'Spacing', self%mesh%finest)
    call put_attribute(self%file, '/VTKHDF', 'Direction', real([1, 0, 0, 0, 1, 0, 0, 0, 1], wp))
  end subroutine introduce_image

  !> The coordinates of the faces are the same at all times, so their offsets are all 0.
  subroutine introduce_graded(self, origin)
    class(vtkhdf_gas_t), intent(inout) :: self
    type(provenance_t), intent(in) :: origin

    integer :: a, n

    call self%introduce('RectilinearGrid', [2, 7], origin)
    call put_attribute(self%file, '/VTKHDF', 'Dimensions', self%mesh%n + 1)
    do a = 1, 3
      n = self%mesh%n(a) + 1
      call self%file%make('/VTKHDF/'//coordinates(a), real_kind, [int(n, i8)], [int(n, i8)])
      call put_columns(self%file, '/VTKHDF/'//coordinates(a), self%mesh%axis(a)%face, whole(n))
    end do
    call self%make_rows(of_steps//'XCoordinatesOffsets', of_steps//['YCoordinatesOffsets', 'ZCoordinatesOffsets'])
  end subroutine introduce_graded

  subroutine begin_step(self, time)
    class(vtkhdf_gas_t), intent(inout) :: self
    real(wp), intent(in) :: time  !< [s]

    call self%begin(time)
  end subroutine begin_step

  !> A number of every cell of my box.
  subroutine add_scalars(self, name, f, unit)
    class(vtkhdf_gas_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    real(wp), intent(in) :: f(:,:,:)  !< (n1, n2, n3)

    if (self%repeated) return
    call know(self, name, unit, 1)
    call put_block(self%file, cell_data//name, real(f, sp), self%lower, int(self%steps, i8))
  end subroutine add_scalars

  !> A vector of every cell of my box.
  subroutine add_vectors(self, name, f, unit)
    class(vtkhdf_gas_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    real(wp), intent(in) :: f(:,:,:,:)  !< (3, n1, n2, n3)

    if (self%repeated) return
    call know(self, name, unit, 3)
    call put_block(self%file, cell_data//name, real(f, sp), self%lower, int(self%steps, i8))
  end subroutine add_vectors

  !> Make the field unless it is there.
  subroutine know(self, name, unit, components)
    type(vtkhdf_gas_t), intent(inout) :: self
    character(len=*), intent(in) :: name, unit
    integer, intent(in) :: components

    integer(i8) :: extent(5), pieces(5)
    integer :: from

    if (self%has_field(cell_data, name, components, single_kind)) return
    from = merge(2, 1, components == 1)
    extent = [components, self%mesh%n, 0]
    pieces = [int(components, i8), self%largest, 1_i8]
    call self%file%make(cell_data//name, single_kind, extent(from:), pieces(from:), compressed=.true.)
    call put_attribute(self%file, cell_data//name, 'unit', unit)
  end subroutine know

  !> Close the step; from now on readers see it.
  subroutine end_step(self, outcome)
    class(vtkhdf_gas_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (self%repeated) return
    call self%close_bulk(outcome)
    if (outcome%failed()) return
    if (self%comm%is_root()) then
      call put_tables(self, of_steps//'CellDataOffsets/'//trim(self%fields(1)%name), outcome)
      call put_sidecar(self, self%steps + 1, .false., outcome)
    end if
    call self%finish(outcome)
  end subroutine end_step

  !> The entries of this step.
  subroutine put_tables(self, offsets, outcome)
    type(vtkhdf_gas_t), intent(inout) :: self
    character(len=*), intent(in) :: offsets  !< the table of those of the first field, and of all
    type(outcome_t), intent(inout) :: outcome

    if (.not. self%file%has(offsets)) call self%make_rows(offsets)
    call put_row(self%file, offsets, self%steps, [int(self%steps, i8)])
    if (.not. self%mesh%uniform) call put_row(self%file, of_steps//'XCoordinatesOffsets', self%steps, [0_i8])
    call self%show_step(offsets, of_steps//'CellDataOffsets/', outcome)
  end subroutine put_tables

  subroutine put_sidecar(self, steps, at_end, outcome)
    type(vtkhdf_gas_t), intent(inout) :: self
    integer, intent(in) :: steps  !< in the file
    logical, intent(in) :: at_end
    type(outcome_t), intent(inout) :: outcome

    if (.not. self%sidecar_is_due(steps, at_end)) return
    call write_grid_sidecar(self%name, self%fields, self%times(:steps), self%mesh, outcome)
  end subroutine put_sidecar

  !> Complete the sidecar.
  subroutine close_gas(self, outcome)
    class(vtkhdf_gas_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    call put_sidecar(self, self%steps, .true., outcome)
    call agree(self%comm, outcome)
  end subroutine close_gas

end module vtkhdf_gas
