!> The file of the gas, gas.vtkhdf: fields on the cells of the uniform grid at every output time, as VTK's temporal
!> ImageData, which ParaView opens; gas.xmf beside it serves ParaView before 5.12 from the same data.
!>
!>   call gas%open(name, boxes, geometry, origin, outcome, after)
!>   call gas%begin_step(time)
!>   call gas%add('void_fraction', eps, '1')      any number of fields, the same in every step
!>   call gas%end_step(outcome)
!>   call gas%close(outcome)
!>
!> Real numbers are stored in single precision and compressed.
module vtkhdf_gas
  use agreement, only: agree
  use boxes, only: boxes_t
  use hdf5_arrays, only: put_block, put_attribute
  use hdf5_file, only: single_kind
  use kinds, only: wp, sp, i8
  use outcome, only: outcome_t
  use provenance, only: provenance_t
  use vtkhdf_steps, only: vtkhdf_t
  use xdmf, only: write_grid_sidecar
  implicit none
  private
  public :: vtkhdf_gas_t

  character(len=*), parameter :: cell_data = '/VTKHDF/CellData/'

  type, extends(vtkhdf_t) :: vtkhdf_gas_t
    private
    integer :: cells(3)          !< of the grid
    integer :: lower(3)          !< first cell of my box
    integer(i8) :: largest(3)    !< cells of the largest box, the piece in which fields are stored
    real(wp) :: geometry(3, 2)   !< lowest corner of the grid and edges of a cell [m]
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
  subroutine open_gas(self, name, boxes, geometry, origin, outcome, after)
    class(vtkhdf_gas_t), intent(out) :: self
    character(len=*), intent(in) :: name      !< ending in .vtkhdf
    type(boxes_t), intent(in) :: boxes
    real(wp), intent(in) :: geometry(3, 2)    !< lowest corner of the grid and edges of a cell [m]
    type(provenance_t), intent(in) :: origin
    type(outcome_t), intent(inout) :: outcome
    real(wp), intent(in), optional :: after   !< [s]

    logical :: fresh
    integer :: a

    self%cells = boxes%cells
    self%lower = boxes%lo
    do a = 1, 3
      self%largest(a) = boxes%comm%max(boxes%n(a))
    end do
    self%geometry = geometry
    call self%start(name, boxes%comm, after, fresh)
    if (boxes%comm%is_root() .and. fresh) then
      call self%introduce('ImageData', origin)
      call put_attribute(self%file, '/VTKHDF', 'WholeExtent', [0, self%cells(1), 0, self%cells(2), 0, self%cells(3)])
      call put_attribute(self%file, '/VTKHDF', 'Origin', geometry(:, 1))
      call put_attribute(self%file, '/VTKHDF', 'Spacing', geometry(:, 2))
      call put_attribute(self%file, '/VTKHDF', 'Direction', real([1, 0, 0, 0, 1, 0, 0, 0, 1], wp))
    end if
    call self%started(outcome)
  end subroutine open_gas

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
    extent = [components, self%cells, 0]
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
    call self%finish('/VTKHDF/Steps/CellDataOffsets/', int(self%steps, i8), outcome)
    if (self%sidecar_is_due(at_end=.false.)) call put_sidecar(self, outcome)
  end subroutine end_step

  subroutine put_sidecar(self, outcome)
    type(vtkhdf_gas_t), intent(in) :: self
    type(outcome_t), intent(inout) :: outcome

    if (self%comm%is_root()) then
      call write_grid_sidecar(self%name, self%fields, self%times(:self%steps), self%cells, self%geometry, outcome)
    end if
    call agree(self%comm, outcome)
  end subroutine put_sidecar

  !> Complete the sidecar.
  subroutine close_gas(self, outcome)
    class(vtkhdf_gas_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (self%sidecar_is_due(at_end=.true.)) call put_sidecar(self, outcome)
  end subroutine close_gas

end module vtkhdf_gas
